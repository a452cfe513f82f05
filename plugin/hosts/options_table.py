# SPDX-License-Identifier: MIT
"""Which options does each host take, and which version has it? Writes, from the program's list of options (options/option_list.h):

    OPTIONS.md                       the table that every host's README points to
    cli/hemibake.1                   the man page
    python/hemibake/bake_options.py  the types of hemibake.bake(**options)
    gltf-transform/options.d.ts      the types of bake(options) and bakeScene(scene, options)
    blender/hemibake/options.py      words, ranges and help for the panel
    gltf-transform/package.json,     their versions; CMake and pip read the header, where the program has its own from
    blender/hemibake/__init__.py, blender_manifest.toml

    python3 plugin/hosts/options_table.py HEMIBAKE [--check]

HEMIBAKE is the program. --check writes nothing and fails if a file is not what would be written.
"""

import json
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))

PYTHON_TYPES = {"flag": "bool", "text": "str | PathLike[str]", "sky": "str | PathLike[str]", "number": "float", "count": "int", "level": 'int | Literal["auto"]', "exposure": 'float | Literal["auto"]'}
TRANSFORM_TYPES = {
    "flag": "boolean",
    "number": "number",
    "count": "number",
    "exposure": "number | 'auto'",
    "sun": "[number, number, number, number?]",
    "sky": "[number, number, number]",
}


def keyword(option):
    return option["name"].lstrip("-").replace("-", "_")


def camel(option):
    first, *rest = option["name"].lstrip("-").split("-")
    return first + "".join(word.capitalize() for word in rest)


def options_of(table, command):
    return table["commands"][command]["options"]


def options_for(table, *hosts):
    """Those of a bake that one of the hosts takes: files, scenes, documents."""
    return [option for option in options_of(table, "bake") if set(hosts) & set(option["hosts"])]


# ---- the table of the hosts ------------------------------------------------------------------------------------------


def value_of(option):
    argument = option.get("argument", "")
    if option["kind"] == "flag":
        return "on"
    if option["kind"] in ("number", "count", "level") and "low" in option:
        return f"{argument.replace('|', ' or ')}, {option['low']:g} to {option['high']:g}"
    return argument.replace("|", " or ")


def markdown(table):
    lines = [
        "# Options of a bake",
        "",
        "Made by `options_table.py` from `options/option_list.h`. Python: `hemibake.bake(path, out,",
        "element_size=0.1)`. glTF-Transform: `bake({ elementSize: 0.1 })`, `gltf-transform bake --element-size 0.1`; what its column lacks",
        "is done by the other transforms, and its `sun` and `environment` are arrays of numbers. CMake and Make: as on the command line.",
        "Defaults follow the quality.",
        "",
        "| command line | Python | glTF-Transform | takes | what it does |",
        "|---|---|---|---|---|",
    ]
    for option in options_of(table, "bake"):
        if option["name"] == "-o":  # an argument of its own in every other host
            continue
        name = f"`{keyword(option)}`" if "files" in option["hosts"] else ""
        text = option["help"].replace("|", "\\|")
        node = f"`{camel(option)}`" if {"scenes", "documents"} & set(option["hosts"]) else ""
        lines.append(f"| `{option['name']}` | {name} | {node} | {value_of(option)} | {text} |")
    return "\n".join(lines) + "\n"


# ---- the man page ----------------------------------------------------------------------------------------------------


def roff(text):
    return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")


def man_page(table):
    lines = [
        f'.TH HEMIBAKE 1 "" "hemibake {table["version"]}" "User Commands"',
        ".SH NAME",
        "hemibake \\- bake diffuse global illumination into glTF vertex colours",
        ".SH SYNOPSIS",
    ]
    for command in table["commands"].values():
        lines += [f"\\fB{roff(command['synopsis'])}\\fR", ".br"]
    for name, command in table["commands"].items():
        lines += [f".SH {name.upper()}", roff(command["help"][0].upper() + command["help"][1:]) + "."]
        for option in command["options"]:
            argument = f" \\fI{roff(option['argument'])}\\fR" if "argument" in option else ""
            lines += [".TP", f"\\fB{roff(option['name'])}\\fR{argument}", roff(option["help"])]
    lines += [
        ".SH EXIT STATUS",
        "0 done; 1 bad input; 2 wrong usage; 3 an output could not be written; 4 stopped before it converged, and the",
        "output is written all the same; 130 interrupted: what was there is written if its estimated error, what is unshot",
        "included, is 25 % or less, else the old output stays; 129, 131, 143, 152 ended by SIGHUP, SIGQUIT, SIGTERM or SIGXCPU,",
        "with nothing.",
        ".SH OUTPUTS",
        "An output appears whole or not at all. What it replaces passes on its mode, links to it are followed, and of several hard",
        "links only the one named becomes the new file. A device, a FIFO or /dev/stdout is written where it is. A process that was",
        "killed may leave .hemibake\\-*.part beside its output; the next bake there removes it.",
        ".SH ENVIRONMENT",
        "\\fBOCIO\\fR: the OpenColorIO configuration, unless \\fB\\-\\-ocio\\fR names one.",
    ]
    return "\n".join(lines) + "\n"


# ---- completion in shells --------------------------------------------------------------------------------------------


NAMES_OF_FILES = ("FILE", "OUT", "PNG", "PROBES", "DIR", "CONFIG", "IN")


def takes_file(option):
    words = re.split(r"[|.,]", option.get("argument", ""))
    return option["kind"] in ("text", "sky") and any(word in NAMES_OF_FILES for word in words)


def literal_words(option):
    """Those of its values that are words; what help shows in capitals, or as an example, stands for something else."""
    words = option.get("argument", "").split("|")
    return [] if option["kind"] != "choice" and takes_file(option) else [word for word in words if re.fullmatch(r"[a-z][a-z-]*", word)]


def names_of(option):
    """Its name as help has it, and those that other programs have for it (name_of in cli/options.c)."""
    return [option["name"], *{"-o": ["--output"], "--quiet": ["-q"]}.get(option["name"], [])]


def help_topics(table):
    options = {option["name"].lstrip("-") for command in table["commands"].values() for option in command["options"]}
    return [*table["commands"], *sorted(options - {"o"})]


def bash_values(option):
    if literal_words(option):
        return f'words="{" ".join(literal_words(option))}"'
    return "files=yes" if takes_file(option) else ":"


def bash_completion(table):
    commands = table["commands"]
    lines = [
        "# SPDX-License-Identifier: MIT",
        "# Which words may come next on the command line, in bash? Made by options_table.py; not edited by hand.",
        "_hemibake() {",
        "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} words= files=",
        "  COMPREPLY=()",
        "  # Bash takes --quality=high for three words.",
        '  if [ "$word" = = ]; then',
        "    word=",
        '  elif [ "$before" = = ]; then',
        "    before=${COMP_WORDS[COMP_CWORD-2]}",
        "  fi",
        '  [ "$COMP_CWORD" -eq 1 ] && before= command=',
        "  case $command:$before in",
        f'    :) words="{" ".join(commands)} help --help --version" ;;',
    ]
    for name, command in commands.items():
        by_values = {}
        for option in command["options"]:
            if "argument" in option:
                by_values.setdefault(bash_values(option), []).extend(f"{name}:{each}" for each in names_of(option))
        lines += [f"    {'|'.join(options)}) {values} ;;" for values, options in by_values.items()]
    lines.append(f'    help:*) words="{" ".join(help_topics(table))}" ;;')
    for name, command in commands.items():
        options = " ".join(each for option in command["options"] for each in names_of(option))
        lines.append(f'    {name}:*) case $word in -*) words="{options} --help" ;; *) files=yes ;; esac ;;')
    lines += [
        "  esac",
        "  # A line of compgen is a name, whatever blanks it has.",
        '  [ -z "$words" ] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")',
        '  [ -z "$files" ] || { compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$word"); }',
        "}",
        "complete -F _hemibake hemibake",
    ]
    return "\n".join(lines) + "\n"


def zsh_text(text):
    return "".join(f"\\{c}" if c in "[]:\\" else c for c in text).replace("'", "'\\''")


def zsh_action(option):
    if literal_words(option):
        return f":word:({' '.join(literal_words(option))})"
    if "argument" not in option:
        return ""
    return ":file:_files" if takes_file(option) else f":{zsh_text(option['argument'])}:"


def zsh_option(option):
    """One name, or several that go instead of each other; a long one takes its value after = too."""
    says = f"[{zsh_text(option['help'])}]{zsh_action(option)}"
    names = [name + ("=" if name.startswith("--") and zsh_action(option) else "") for name in names_of(option)]
    if len(names) == 1:
        return [f"'{names[0]}{says}'"]
    return [f"'({' '.join(names_of(option))})'{name}'{says}'" for name in names]


def zsh_completion(table):
    commands = table["commands"]
    lines = [
        "#compdef hemibake",
        "# SPDX-License-Identifier: MIT",
        "# Which words may come next on the command line, in zsh? Made by options_table.py; not edited by hand.",
        "_hemibake() {",
        "  if (( CURRENT == 2 )); then",
        "    local -a commands=(",
    ]
    lines += [f"      '{name}:{zsh_text(command['help'])}'" for name, command in commands.items()]
    lines += [
        "      'help:of a command, or of an option'",
        "    )",
        "    _describe command commands",
        "    _arguments '--help[which commands there are]' '--version[which version this is]'",
        "    return",
        "  fi",
        "  local command=$words[2]",
        "  shift words",
        "  (( CURRENT-- ))",
        "  case $command in",
        f"    help) _values topic {' '.join(help_topics(table))} ;;",
    ]
    for name, command in commands.items():
        lines.append(f"    {name}) _arguments \\")
        lines += [f"      {spec} \\" for option in command["options"] for spec in zsh_option(option)]
        lines += ["      '(- *)--help[what it does, and its options]' \\", "      '*:file:_files' ;;"]
    lines += ["  esac", "}", '_hemibake "$@"']
    return "\n".join(lines) + "\n"


# ---- the types of Python ---------------------------------------------------------------------------------------------


def python_type(option):
    if option["kind"] == "choice":
        return "Literal[" + ", ".join(f'"{word}"' for word in option["argument"].split("|")) + "]"
    return PYTHON_TYPES.get(option["kind"], "str")


def python_types(table):
    lines = [
        "# SPDX-License-Identifier: MIT",
        '"""Which options does hemibake.bake take? Made by plugin/hosts/options_table.py; not edited by hand."""',
        "",
        "from __future__ import annotations",
        "",
        "from os import PathLike",
        "from typing import Literal, TypedDict",
        "",
        "",
        "class BakeOptions(TypedDict, total=False):",
        '    """Every option of \'hemibake bake\', with _ for -."""',
    ]
    for option in options_for(table, "files"):
        lines += ["", f"    {keyword(option)}: {python_type(option)}", f'    """{option["help"]}"""']
    return "\n".join(lines) + "\n"


# ---- the types of TypeScript -----------------------------------------------------------------------------------------


def transform_type(option):
    if option["kind"] == "choice":
        return " | ".join(f"'{word}'" for word in option["argument"].split("|"))
    return TRANSFORM_TYPES.get(option["kind"], "string")


def transform_types(table):
    lines = ["// SPDX-License-Identifier: MIT", "// Which options do bakeScene and bake take? Made by plugin/hosts/options_table.py; not edited by hand."]
    for name, what, host in (
        ("SceneOptions", "What a bake of arrays and of a Document share. What is missing follows from the quality.", "scenes"),
        ("DocumentOptions", "What only a bake of a Document takes.", "documents"),
    ):
        lines += ["", f"/** {what} */", f"export interface {name} {{"]
        for option in options_for(table, host):
            lines += [f"\t/** {option['help']} */", f"\t{camel(option)}?: {transform_type(option)};"]
        lines += ["}"]
    return "\n".join(lines) + "\n"


# ---- the panel of Blender --------------------------------------------------------------------------------------------


def blender_options(table):
    lines = [
        "# SPDX-License-Identifier: MIT",
        '"""Which options does the program have? Made by plugin/hosts/options_table.py; not edited by hand."""',
        "",
        "OPTIONS = {",
    ]
    for option in options_for(table, "files"):
        facts = {"help": option["help"]}
        if option["kind"] == "choice":
            facts["words"] = option["argument"].split("|")
        if "low" in option:
            facts["low"], facts["high"] = option["low"], option["high"]
        lines.append(f'    "{keyword(option)}": {json.dumps(facts)},')
    return "\n".join([*lines, "}"]) + "\n"


# ---- versions --------------------------------------------------------------------------------------------------------


def with_version(name, pattern, version):
    """The file with `version` in place of what the pattern's group matches."""

    def make(_table):
        with open(os.path.join(HERE, name)) as f:
            text = f.read()
        at = re.search(pattern, text)
        return text[: at.start(1)] + version + text[at.end(1) :]

    return make


# ---- files -----------------------------------------------------------------------------------------------------------


def main():
    program, check = sys.argv[1], "--check" in sys.argv[2:]
    table = json.loads(subprocess.run([program, "help", "--json"], capture_output=True, check=True, text=True).stdout)
    npm, blender, manifest = "gltf-transform/package.json", "blender/hemibake/__init__.py", "blender/hemibake/blender_manifest.toml"
    stale = []
    for name, make in (
        ("OPTIONS.md", markdown),
        ("cli/hemibake.1", man_page),
        ("cli/hemibake.bash", bash_completion),
        ("cli/_hemibake", zsh_completion),
        ("python/hemibake/bake_options.py", python_types),
        ("gltf-transform/options.d.ts", transform_types),
        ("blender/hemibake/options.py", blender_options),
        (npm, with_version(npm, r'"version": "([\d.]+)"', table["version"])),
        (manifest, with_version(manifest, r'\nversion = "([\d.]+)"', table["version"])),
        (blender, with_version(blender, r'"version": \(([\d, ]+)\)', table["version"].replace(".", ", "))),
    ):
        path, text = os.path.join(HERE, name), make(table)
        if os.path.exists(path) and open(path).read() == text:
            continue
        stale.append(name)
        if not check:
            open(path, "w").write(text)
    if check and stale:
        sys.exit(f"options_table.py: {', '.join(stale)}: not what the program's table says; run it without --check")


main()
