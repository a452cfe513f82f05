# SPDX-License-Identifier: MIT
"""Does a bake hold when the machine around it fails? One table, and the number of faults that it did not stand as exit status.

    faults.py [--kills N] [--scenes 1..3] [--refusals N] [--only NAME]
"""

import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
import command  # noqa: E402
import gltf_file  # noqa: E402

SEED, PATIENCE_S = 1989, 120
BROKEN_CALLS = os.environ.get("HEMIBAKE_BROKEN_CALLS", os.path.join(command.ROOT, "build/release/tests/broken_calls.so"))
OUTPUTS = ("out.glb", "out.json", "out.png")
OPTIONS = ("-o", "out.glb", "--report", "out.json", "--preview", "out.png", "--size", "64x48", "--quality", "draft", "--quiet")
OLD = b"good and old"
PART = re.compile(r"\.hemibake-[0-9a-f]{16}\.part")
SAMPLES = {"room": None, "pillar-room": "pillar-room.glb", "pavilion": "pavilion/pavilion.glb"}
SCENE_OPTIONS = {"pavilion": ("--patch-size", "2.25", "--element-size", "0.7", "--unshot", "0.1")}


class Fell(Exception):
    """A fault that the bake did not stand, and how."""


class Folder:
    """An empty folder with a scene and, where asked for, old outputs."""

    def __init__(self, scene="room", old=True):
        self.scene, self.old = scene, old

    def __enter__(self):
        self.path = tempfile.mkdtemp(prefix="hemibake faults ")
        if SAMPLES[self.scene]:
            shutil.copy(os.path.join(command.SAMPLES, SAMPLES[self.scene]), self.at("in.glb"))
        else:
            with open(self.at("in.glb"), "wb") as f:
                f.write(gltf_file.room().glb())
        self.restore()
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.path)

    def at(self, name):
        return os.path.join(self.path, name)

    def restore(self):
        for name in OUTPUTS if self.old else ():
            with open(self.at(name), "wb") as f:
                f.write(OLD)

    def arguments(self):
        return [command.HEMIBAKE, "bake", "in.glb", *OPTIONS, *SCENE_OPTIONS.get(self.scene, ())]

    def start(self, *more, broken="", env=None, **popen):
        env = dict(os.environ, **(env or {}))
        if broken:
            env.update(LD_PRELOAD=BROKEN_CALLS, HEMIBAKE_BROKEN=broken)
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **popen}
        return subprocess.Popen([*self.arguments(), *more], cwd=self.path, env=env, text=True, errors="replace", **streams)

    def bake(self, *more, statuses, **popen):
        process = self.start(*more, **popen)
        try:
            _, said = process.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Fell(f"no end in {PATIENCE_S} s") from None
        if process.returncode not in statuses:
            raise Fell(f"status {process.returncode}: {said.strip()[-160:]}")
        # What the C++ runtime and LLVM say themselves, on their way to abort(), stands before it.
        ours = re.sub(r"^(terminate called after throwing |  what\(\): |LLVM ERROR: |Allocation failed)[^\n]*\n", "",
                      said or "", flags=re.MULTILINE)
        if process.returncode not in (command.DONE, 127) and not re.fullmatch(r"hemibake: [^\n]+\n", ours):
            raise Fell(f"not one line: {said!r}")
        return process.returncode

    def check_outputs(self, parts=False):
        """Each is the old one or a whole new one, and nothing is beside them. Returns which are new."""
        new = set()
        for name in OUTPUTS:
            if not os.path.exists(self.at(name)):
                if self.old:
                    raise Fell(f"{name} is gone")
                continue
            with open(self.at(name), "rb") as f:
                data = f.read()
            ends = {"out.glb": lambda: int.from_bytes(data[8:12], "little") == len(data), "out.json": lambda: data.rstrip().endswith(b"}"),
                    "out.png": lambda: data.endswith(b"IEND\xaeB`\x82")}
            if data == OLD:
                continue
            if not data or not ends[name]():
                raise Fell(f"{name} is torn")
            new.add(name)
        beside = [n for n in os.listdir(self.path) if n not in ("in.glb", *OUTPUTS)]
        if [n for n in beside if not (parts and PART.fullmatch(n))]:
            raise Fell(f"left beside: {beside}")
        return new

    def check_old(self):
        if self.check_outputs():
            raise Fell("an old output was replaced")


# ---- faults ------------------------------------------------------------------------------------------------------------


def mounted(options, script):
    """Runs a script in a mount namespace of its own with a tmpfs at /mnt; None: that is not possible here."""
    user = [] if os.geteuid() == 0 else ["-r"]
    whole = f'mount -t tmpfs -o {options} none /mnt 2>/dev/null || exit 99; {script}'
    ran = subprocess.run(["unshare", *user, "-m", "sh", "-c", whole, command.HEMIBAKE], capture_output=True, text=True, timeout=PATIENCE_S)
    return None if ran.returncode == 99 or "unshare" in ran.stderr else ran


def full_disk():
    """A small tmpfs, from no room at all to nearly enough."""
    held = 0
    with Folder() as f:
        for blocks in (1, 2, 3, 4, 6):
            ran = mounted(f"size={4096 * blocks}", f'cd /mnt; printf "{OLD.decode()}" > out.glb; "$0" bake "{f.at("in.glb")}" -o out.glb '
                          '--quality draft --no-draco --quiet --report out.json; echo "status $?"; ls -A; head -c 12 out.glb')
            if ran is None:
                return None
            expected = f"status 3\nout.glb\n{OLD.decode()}"
            if ran.stdout != expected or ran.stderr.count("\n") != 1:
                raise Fell(f"{blocks} blocks: {ran.stdout!r} {ran.stderr!r}")
            held += 1
    return held, "exit 3, the old output stays"


def read_only():
    with Folder() as f:
        ran = mounted("ro", f'cd /mnt; "$0" bake "{f.at("in.glb")}" -o out.glb --quality draft; echo "status $?"')
    if ran is None:
        return None
    if ran.stdout != "status 3\n" or not re.fullmatch(r"hemibake: out\.glb: [^\n]+\n", ran.stderr):
        raise Fell(f"{ran.stdout!r} {ran.stderr!r}")
    return 1, "exit 3 before any work"


def calls_fail():
    if not os.path.exists(BROKEN_CALLS):
        return None
    held = 0
    for calls, statuses in (("link", (3,)), ("rename", (3,)), ("fsync", (3,)), ("tmpfile rename", (3,)), ("tmpfile fsync", (3,)),
                            ("tmpfile", (0,)), ("lock", (0,)), ("tmpfile lock", (0,))):
        with Folder() as f:
            status = f.bake(statuses=statuses, broken=calls)
            if status == 3:
                f.check_old()
            elif len(f.check_outputs()) != len(OUTPUTS):
                raise Fell(f"{calls}: not all outputs are new")
            held += 1
    return held, "exit 3 and the old outputs, or another way"


def kills(scene, count, broken=""):
    """SIGKILL at random moments: outputs are old or whole; what may be left beside goes at the next start."""
    source, parts = random.Random(SEED), 0
    with Folder(scene) as f:
        begin = time.monotonic()
        f.bake(statuses=(0,), broken=broken)
        took = time.monotonic() - begin
        for _ in range(count):
            f.restore()
            process = f.start(broken=broken, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                process.wait(timeout=source.uniform(0, 1.1 * took))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            f.check_outputs(parts=True)
            parts += any(PART.fullmatch(n) for n in os.listdir(f.path))
        f.bake(statuses=(0,))
        f.check_outputs()
    return count, f"{parts} left a part, which the next bake removed"


def resumed(scene, method, count):
    """SIGKILL at random moments, also of bakes that go on: what comes out in the end has the bytes of one that was let be."""
    source, left, chains = random.Random(SEED), count, 0
    with Folder(scene, old=False) as f:
        begin = time.monotonic()
        f.bake("--method", method, statuses=(0,))
        took = time.monotonic() - begin
        with open(f.at("out.glb"), "rb") as whole:
            expected = whole.read()
        while left > 0:
            os.remove(f.at("out.glb"))
            how, chains = "--checkpoint", chains + 1
            while True:
                process = f.start("--method", method, how, "kept", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                try:
                    # Now and then the bake is let come to its end.
                    process.wait(timeout=PATIENCE_S if left == 0 or source.random() < 0.2 else source.uniform(0, took))
                    break
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                    left -= 1
                how = "--resume" if os.path.exists(f.at("kept")) else "--checkpoint"
            if process.returncode != 0:
                raise Fell(f"{how} after {count - left} kills: status {process.returncode}")
            with open(f.at("out.glb"), "rb") as again:
                if again.read() != expected:
                    raise Fell(f"other bytes after {count - left} kills")
            if os.path.exists(f.at("kept")):
                raise Fell("the checkpoint of a whole bake is left")
    return count, f"{chains} bakes, of the same bytes each"


def wait_until_it_listens(process):
    """Before, a signal meets the loader, which nobody has told anything: on a busy machine that takes a second."""
    end = time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < end:
        with open(f"/proc/{process.pid}/status", encoding="ascii", errors="replace") as f:
            ignored, caught = (int(line.split()[1], 16) for line in f if line.startswith(("SigIgn:", "SigCgt:")))
        if all((ignored | caught) >> (number - 1) & 1 for number in (signal.SIGINT, signal.SIGPIPE)):
            return
        time.sleep(0.01)


def every_signal():
    promised = {signal.SIGINT: (0, 130), signal.SIGTERM: (0, 143), signal.SIGHUP: (0, 129), signal.SIGQUIT: (0, 131), signal.SIGXCPU: (0, 152),
                signal.SIGPIPE: (0,), signal.SIGXFSZ: (0,)}
    stops = (signal.SIGSTOP, signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU)
    count = 0
    for number in sorted(signal.valid_signals()):
        if number in stops:
            continue
        with Folder("pillar-room") as f:
            process = f.start()
            wait_until_it_listens(process)
            try:
                process.wait(timeout=0.5)
            except subprocess.TimeoutExpired:
                process.send_signal(number)
            process.communicate(timeout=PATIENCE_S)
            if process.returncode not in promised.get(number, (0, -number)):
                raise Fell(f"signal {number}: status {process.returncode}")
            if process.returncode in (129, 131, 143, 152):
                f.check_old()
            new = f.check_outputs()
            # What an interrupt leaves is written where its estimate is good enough, and then all of it.
            if process.returncode == 130 and new and len(new) != len(OUTPUTS):
                raise Fell(f"signal {number}: only {new} are new")
            count += 1
    return count, "promised statuses, nothing left"


def closed_pipes():
    redirects = {">&-": 0, "2>&-": 0, "<&-": 0, "<&- >&- 2>&-": 0, "| true": 0, "2>&1 >/dev/null | true": 0}
    for redirect in redirects:
        with Folder() as f:
            words = " ".join(f"'{w}'" for w in f.arguments())
            subprocess.run(["sh", "-c", f"{words} --progress json {redirect}"], cwd=f.path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                           timeout=PATIENCE_S, check=False)
            if len(f.check_outputs()) != len(OUTPUTS):
                raise Fell(f"{redirect}: not all outputs are there")
    return len(redirects), "baked"


def limited(kind, values, statuses, what):
    """Under limits of the process: it bakes or says why not. What the loader cannot start is counted apart."""
    done = unstarted = 0
    for value in values:
        with Folder() as f:
            def limit(value=value):
                resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
                resource.setrlimit(kind, (value, resource.getrlimit(kind)[1]))
            status = f.bake(statuses=statuses, preexec_fn=limit)
            done += status == 0
            unstarted += status == 127
            (f.check_outputs if status == 0 else f.check_old)()
    return len(values), f"{done} baked, {len(values) - done - unstarted} {what}, {unstarted} not started by the loader"


def no_config():
    with Folder() as f:
        f.bake("--ocio", "lost.ocio", statuses=(1,))
        f.bake(statuses=(1,), env={"OCIO": "lost.ocio"})
        f.check_old()
    return 2, "exit 1, named"


# What is asked of the C library after the start of main(), request by request. Options are small, and the driver is in it.
MEMORY_RUNS = {"bake by rows": ("bake", "in.glb", "-o", "out.glb", "--report", "out.json", "--quality", "draft", "--method", "rows", "--threads", "1"),
               "bake by columns": ("bake", "in.glb", "-o", "out.glb", "--quality", "draft", "--method", "hybrid", "--no-draco", "--threads", "2"),
               "inspect": ("inspect", "in.glb"), "render": ("render", "in.glb", "-o", "out.png", "--size", "64x48"),
               "render from a place": ("render", "in.glb", "-o", "out.png", "--size", "64x48", "--look-from", "2,1,2"),
               "factors": ("factors", os.path.join(command.SAMPLES, "l-room.vs3"), "--tolerance", "0.1")}
ENDS_BY_MEMORY = re.compile(r"(?s)(terminate called|LLVM ERROR|.*?hemibake: [^\n]*(memory|no room for|could not be drawn)[^\n]*\n\Z)")


def refused(arguments, count, source):
    """One request is refused, or all from one on: done, or a line that says memory; and what was there stays."""
    with Folder() as f:
        def run(at, **env):
            env = dict(os.environ, LD_PRELOAD=BROKEN_CALLS, HEMIBAKE_BROKEN_MEMORY=at, **env)
            return subprocess.run([command.HEMIBAKE, *arguments], cwd=f.path, env=env, capture_output=True, text=True, errors="replace",
                                  timeout=PATIENCE_S, check=False)
        if arguments[0] == "render":  # of what has light, else nothing is drawn
            subprocess.run([command.HEMIBAKE, "bake", "in.glb", "-o", "in.glb", "--force", "--quality", "draft", "--no-draco", "--quiet"],
                           cwd=f.path, timeout=PATIENCE_S, check=True)
        counted = run("0", HEMIBAKE_COUNT=f.at("count"))
        if counted.returncode != 0:
            raise Fell(f"with all its memory: status {counted.returncode}: {counted.stderr.strip()[-160:]!r}")
        f.restore()
        with open(f.at("count"), encoding="ascii") as counted:
            requests = int(counted.read())
        os.remove(f.at("count"))
        done = 0
        for i in range(count):
            f.restore()
            # Evenly over all of them, wherever in its share.
            at = f"{1 + int(requests * (i + source.random()) / count)}{'+' * (i % 3 == 2)}"
            ran = run(at)
            done += ran.returncode == 0
            if ran.returncode not in (0, 1, 3) or (ran.returncode != 0 and not ENDS_BY_MEMORY.match(ran.stderr)):
                raise Fell(f"request {at} of {requests}: status {ran.returncode}: {ran.stderr.strip()[-160:]!r}")
            (f.check_outputs if ran.returncode == 0 else f.check_old)()
    return count, f"of {requests} requests; {done} did without, {count - done} said so"


# What a picture is made of is asked for soon after the asset has been read; these are all looked at, one by one.
REQUESTS_OF_DRAWING = 100


def refused_while_drawing(arguments):
    with Folder() as f:
        subprocess.run([command.HEMIBAKE, "bake", "in.glb", "-o", "in.glb", "--force", "--quality", "draft", "--no-draco", "--quiet"], cwd=f.path,
                       timeout=PATIENCE_S, check=True)

        def run(at):
            env = dict(os.environ, LD_PRELOAD=BROKEN_CALLS, HEMIBAKE_BROKEN_MEMORY=str(at))
            return subprocess.run([command.HEMIBAKE, *arguments], cwd=f.path, env=env, capture_output=True, text=True, errors="replace",
                                  timeout=PATIENCE_S, check=False)
        low, high = 1, 1 << 20
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if "to read the asset" in run(middle).stderr else (low, middle)
        drawing = 0
        for at in range(high, high + REQUESTS_OF_DRAWING):
            ran = run(at)
            drawing += "while drawing" in ran.stderr
            if ran.returncode not in (0, 1, 3) or (ran.returncode != 0 and not ENDS_BY_MEMORY.match(ran.stderr)):
                raise Fell(f"request {at}: status {ran.returncode}: {ran.stderr.strip()[-160:]!r}")
        if not drawing:
            raise Fell("nothing was refused while drawing")
    return REQUESTS_OF_DRAWING, f"{drawing} while drawing, which was said"


MB = 1 << 20


def faults(options):
    scenes = list(SAMPLES)[:options.scenes]
    for path in options.scene:
        scenes.append(os.path.basename(path))
        SAMPLES[scenes[-1]] = os.path.abspath(path)
    yield "small tmpfs full", full_disk
    yield "folder read-only", read_only
    yield "calls fail: no space to name, to rename; fsync; no O_TMPFILE; no locks", calls_fail
    for scene in scenes:
        yield f"killed at random moments, {scene}", lambda scene=scene: kills(scene, options.kills)
    for scene in scenes:
        for method in ("hybrid", "rows"):
            yield f"killed and gone on with, {scene}, {method}", lambda s=scene, m=method: resumed(s, m, options.kills)
    if os.path.exists(BROKEN_CALLS):
        yield "killed at random moments, no O_TMPFILE", lambda: kills("room", options.kills, broken="tmpfile")
    for what, arguments in MEMORY_RUNS.items() if os.path.exists(BROKEN_CALLS) else ():
        yield f"memory refused, {what}", lambda arguments=arguments: refused(arguments, options.refusals, random.Random(SEED))
    if os.path.exists(BROKEN_CALLS):
        yield "memory refused while drawing", lambda: refused_while_drawing(MEMORY_RUNS["render from a place"])
    yield "every signal", every_signal
    yield "closed streams and pipes", closed_pipes
    yield "few descriptors", lambda: limited(resource.RLIMIT_NOFILE, (8, 10, 12, 16, 24, 32), (0, 1, 3, 127), "said why not")
    sizes = [x * MB for x in (256, 288, 320, 352, 384, 512, 768, 1024, 2048, 4096)]
    yield "address space 0.25 to 4 GB", lambda: limited(resource.RLIMIT_AS, sizes, (0, 1, 127), "said why not")
    yield "files of 1 to 20 kB at most", lambda: limited(resource.RLIMIT_FSIZE, (1024, 4096, 20480), (0, 3), "exit 3")
    yield "OCIO configuration missing", no_config


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=8)
    parser.add_argument("--scenes", type=int, default=1)
    parser.add_argument("--scene", action="append", default=[], help="a .glb that is killed too")
    parser.add_argument("--refusals", type=int, default=4)
    parser.add_argument("--only", default="", help="faults of which the name begins so")
    options, short = parser.parse_args(), 0
    print(f"{'fault':<72} {'runs':>5}  held")
    for name, fault in faults(options):
        if not name.startswith(options.only):
            continue
        try:
            found = fault()
        except Fell as fell:
            print(f"{name:<72} {'':>5}  NO: {fell}", flush=True)
            short += 1
            continue
        runs, note = found if found else ("", "skipped: this machine cannot make it")
        print(f"{name:<72} {runs:>5}  {'yes: ' if found else ''}{note}", flush=True)
    sys.exit(min(short, 76))


if __name__ == "__main__":
    main()
