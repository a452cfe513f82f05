# SPDX-License-Identifier: MIT
"""Which libraries do our programs load, and our pages bundle, of which version and licence? For sbom.sh: sbom.py FOLDER PROGRAM ...

Debian's dpkg says which package a library is of and which version; the licence is that of the package's copyright file, by the table below
where that file is older than the machine-readable form.
"""

import json
import os
import re
import subprocess
import sys
from datetime import datetime, timezone

from spdx_tools.spdx.model import (Actor, ActorType, CreationInfo, Document, ExtractedLicensingInfo, Package, Relationship, RelationshipType, SpdxNoAssertion)
from spdx_tools.spdx.parser.parse_anything import parse_file
from spdx_tools.spdx.validation.document_validator import validate_full_spdx_document
from spdx_tools.spdx.writer.write_anything import write_file
from spdx_tools.common.spdx_licensing import spdx_licensing

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

# What the copyright files of these say in prose, as SPDX has it: source package, licence of the library itself.
KNOWN = {
    "glibc": "LGPL-2.1-or-later", "gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1", "mesa": "MIT", "llvm-toolchain-15": "Apache-2.0 WITH LLVM-exception",
    "embree": "Apache-2.0", "onetbb": "Apache-2.0", "draco": "Apache-2.0", "tinygltf": "MIT", "opensubdiv": "Apache-2.0", "opencolorio": "BSD-3-Clause",
    "libpng1.6": "libpng-2.0", "cjson": "MIT", "libmd": "BSD-3-Clause", "meshoptimizer": "MIT", "libstb": "MIT OR Unlicense", "libjpeg-turbo": "IJG AND BSD-3-Clause",
    "libwebp": "BSD-3-Clause", "xxhash": "BSD-2-Clause", "zlib": "Zlib", "openexr": "BSD-3-Clause", "imath": "BSD-3-Clause", "expat": "MIT",
    "yaml-cpp": "MIT", "pystring": "BSD-3-Clause", "minizip-ng": "Zlib", "libzstd": "BSD-3-Clause", "xz-utils": "LicenseRef-public-domain", "bzip2": "bzip2-1.0.6",
    "openssl": "Apache-2.0", "libffi": "MIT", "libedit": "BSD-3-Clause", "ncurses": "X11-distribute-modifications-variant", "libxml2": "MIT", "icu": "Unicode-DFS-2016",
    "libbsd": "BSD-3-Clause", "libdrm": "MIT", "elfutils": "LGPL-3.0-or-later OR GPL-2.0-or-later", "libglvnd": "MIT", "libx11": "MIT", "libxcb": "MIT",
    "libxau": "MIT", "libxdmcp": "MIT", "z3": "MIT", "wayland": "MIT", "lm-sensors": "LGPL-2.1-or-later", "libunwind": "MIT", "numactl": "LGPL-2.1-only",
    "libzip": "BSD-3-Clause", "libglu": "MIT", "libstdc++": "GPL-3.0-or-later WITH GCC-exception-3.1",
}


def run(*words):
    return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout


def package_of(path):
    """dpkg knows a file by the name it was installed under, which /lib and /usr/lib both are."""
    for name in {path, os.path.realpath(path), "/usr" + os.path.realpath(path), re.sub("^/usr", "", os.path.realpath(path))}:
        found = run("dpkg-query", "-S", name)
        if found:
            return found.split(": ")[0].split(",")[0]
    return None


def licence_of(source, package):
    if source in KNOWN:
        return KNOWN[source]
    path = f"/usr/share/doc/{package.split(':')[0]}/copyright"
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8", errors="replace") as f:
        first = re.search(r"^Files:\s*\*.*?^License:\s*(\S+)", f.read(), re.MULTILINE | re.DOTALL)
    return {"Expat": "MIT", "BSD-3-clause": "BSD-3-Clause"}.get(first[1], first[1]) if first else None


def libraries(programs):
    """(source package, version, licence, libraries) in alphabetical order."""
    found = {}
    for program in programs:
        for path in re.findall(r"=> (/\S+)", run("ldd", program)):
            package = package_of(path)
            source = run("dpkg-query", "-W", "-f", "${source:Package}", package).strip() if package else os.path.basename(path)
            version = run("dpkg-query", "-W", "-f", "${source:Version}", package).strip() if package else "unknown"
            entry = found.setdefault(source, [version, licence_of(source, package or ""), set()])
            entry[2].add(os.path.basename(path))
    return sorted((source, *entry) for source, entry in found.items())


def bundled():
    """What is in the pages that the command writes and serves, from npm, by the locks of their folders."""
    rows = []
    for folder, name, page in (("plugin/hosts/cli", "uplot", "page of --report"), ("samples/web-viewer", "three", "page of view")):
        with open(os.path.join(ROOT, folder, "package-lock.json"), encoding="utf-8") as f:
            package = json.load(f)["packages"]["node_modules/" + name]
        rows.append((name, package["version"], package.get("license"), {page}))
    return rows


def document(rows):
    made = datetime.fromtimestamp(int(run("git", "-C", ROOT, "log", "-1", "--format=%ct") or 0), timezone.utc).replace(tzinfo=None)
    info = CreationInfo(spdx_version="SPDX-2.3", spdx_id="SPDXRef-DOCUMENT", name="hemibake and the libraries it loads", data_license="CC0-1.0",
                        document_namespace="urn:hemibake:sbom:" + run("git", "-C", ROOT, "rev-parse", "HEAD").strip(),
                        creators=[Actor(ActorType.TOOL, "tests/sbom.py with spdx-tools")], created=made)
    own = Package(spdx_id="SPDXRef-hemibake", name="hemibake", download_location=SpdxNoAssertion(), files_analyzed=False,
                  license_declared=spdx_licensing.parse("MIT"))
    out = Document(info, packages=[own], relationships=[Relationship("SPDXRef-DOCUMENT", RelationshipType.DESCRIBES, own.spdx_id)])
    out.extracted_licensing_info.append(ExtractedLicensingInfo(
        license_id="LicenseRef-public-domain", license_name="public domain", extracted_text="This file has been put into the public domain."))
    for source, version, licence, names in rows:
        one = Package(spdx_id="SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", source), name=source, version=version, download_location=SpdxNoAssertion(),
                      files_analyzed=False, license_declared=spdx_licensing.parse(licence) if licence else SpdxNoAssertion(),
                      comment="libraries: " + " ".join(sorted(names)))
        out.packages.append(one)
        out.relationships.append(Relationship(own.spdx_id, RelationshipType.DEPENDS_ON, one.spdx_id))
    return out


def main():
    folder, *programs = sys.argv[1:]
    rows = libraries(programs) + bundled()
    path = os.path.join(folder, "libraries.spdx.json")
    write_file(document(rows), path, validate=False)
    wrong = [m.validation_message for m in validate_full_spdx_document(parse_file(path))]
    with open(os.path.join(folder, "libraries.md"), "w", encoding="utf-8") as f:
        f.write("| source package | version | licence | libraries |\n|---|---|---|---|\n")
        for source, version, licence, names in rows:
            f.write(f"| {source} | {version} | {licence or '?'} | {', '.join(sorted(names))} |\n")
    unknown = [source for source, _, licence, _ in rows if not licence]
    for line in wrong + [f"{source} has no known licence" for source in unknown]:
        print(line)
    print(f"{len(rows)} packages of libraries, {len(unknown)} without a known licence, {len(wrong)} faults of the document; {path}")
    return 1 if wrong or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
