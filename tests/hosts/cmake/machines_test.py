# SPDX-License-Identifier: MIT
"""Can bakes be spread over many machines, with failures that stop no other, and their reports gathered? By a Slurm cluster of
one node, which this test starts in its own folder."""

import glob
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from host import BUILD, SAMPLES, HostCase, main

PIPELINE = os.path.join(SAMPLES, "asset-pipeline")
DAEMONS = ("munged", "slurmctld", "slurmd", "sbatch")
COUNT = 5  # of the pipeline's twenty: more than there are cores, a failure and a restart

CONF = """
ClusterName=here
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
AccountingStorageType=accounting_storage/none
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Pipelined(HostCase):
    def setUp(self):
        super().setUp()
        for name in ("Makefile", "slurm-array.sh", "report_merge.py"):
            shutil.copy(os.path.join(PIPELINE, name), self.folder)
        self.run_program(sys.executable, os.path.join(PIPELINE, "assets.py"), self.path("assets"))
        for path in glob.glob(self.path("assets/*.gltf")):
            if int(path[-7:-5]) > COUNT:
                os.unlink(path)
        self.environment = dict(os.environ, HEMIBAKE=os.path.join(BUILD, "bin/hemibake"))

    def break_asset(self, number):
        """Returns a function that mends it."""
        path = self.path(f"assets/niche-{number:02}.gltf")
        with open(path, "rb") as f:
            kept = f.read()
        with open(path, "w") as f:
            f.write("{}")

        def mend():
            with open(path, "wb") as f:
                f.write(kept)

        return mend

    def baked(self):
        return {os.path.basename(path): os.stat(path).st_mtime_ns for path in glob.glob(self.path("baked/*.glb"))}

    def merge(self, status):
        with open(self.path("names.txt"), "w") as f:
            f.write(self.run_program("make", "-s", "list", env=self.environment).stdout)
        reports = sorted(glob.glob(self.path("baked/*.json")))
        ran = self.run_program(sys.executable, "report_merge.py", "--expect", "names.txt", "-o", "all.json", *reports,
                               status=status)
        with open(self.path("all.json")) as f:
            return json.load(f), ran

    def check_failure_and_restart(self, bake_all):
        """One asset is broken; then it is mended."""
        mend = self.break_asset(5)
        bake_all(fails=True)
        first = self.baked()
        self.assertEqual(len(first), COUNT - 1)
        whole, ran = self.merge(status=1)
        self.assertEqual(whole["failed"], ["baked/niche-05.glb"])
        self.assertIn("niche-05.glb  FAILED", ran.stdout)
        self.assertEqual(whole["total"]["assets"], COUNT - 1)

        mend()
        bake_all(fails=False)
        second = self.baked()
        self.assertEqual({name for name in second if second[name] != first.get(name)}, {"niche-05.glb"})
        whole, _ = self.merge(status=0)
        self.assertEqual((whole["failed"], whole["total"]["assets"]), ([], COUNT))
        self.assertAlmostEqual(whole["total"]["seconds"], sum(asset["seconds"] for asset in whole["assets"]))


class Cores(Pipelined):
    def test_make_spreads_over_cores(self):
        self.check_failure_and_restart(
            lambda fails: self.run_program("make", "-k", "-j2", env=self.environment, status=2 if fails else 0))

    def test_what_is_no_report_is_told(self):
        for name, text in (("a.json", "{}"), ("b.json", "not json"), ("c.json", "[]")):
            with open(self.path(name), "w") as f:
                f.write(text)
        ran = self.run_program(sys.executable, "report_merge.py", "a.json", "b.json", "c.json", "d.json", status=1)
        self.assertEqual(len(ran.stderr.splitlines()), 4)
        self.assertIn("0 baked, 0 failed", ran.stdout)


@unittest.skipUnless(all(map(shutil.which, DAEMONS)), "no Slurm here (apt install slurm-wlm munge)")
class Cluster(Pipelined):
    def setUp(self):
        super().setUp()
        # A folder of its own: sockets have short names, and Slurm's configuration no spaces.
        self.cluster = f"/tmp/hemibake-slurm-{os.getpid()}"
        for name in ("state", "spool"):
            os.makedirs(os.path.join(self.cluster, name))
        self.addCleanup(shutil.rmtree, self.cluster)
        self.start_munge()
        with open(f"{self.cluster}/slurm.conf", "w") as f:
            user = self.run_program("id", "-un").stdout.strip()
            host = socket.gethostname().split(".")[0]
            f.write(CONF.format(folder=self.cluster, host=host, user=user, ports=free_ports(2)))
        self.environment["SLURM_CONF"] = f"{self.cluster}/slurm.conf"
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D")
        self.wait_for_node()

    def start(self, *command):
        log = open(f"{self.cluster}/{command[0]}.log", "w")
        daemon = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        log.close()
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)

    def start_munge(self):
        key = f"{self.cluster}/munge.key"
        with open(key, "wb") as f:
            f.write(os.urandom(128))
        os.chmod(key, 0o600)
        places = [f"--{what}={self.cluster}/munge.{end}" for what, end in
                  (("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))]
        self.start("munged", "--foreground", "--force", *places)

    def wait_for_node(self):
        for _ in range(120):
            ran = self.run_program("sinfo", "-h", "-o", "%t", env=self.environment, status=None)
            if ran.stdout.strip() == "idle":
                return
            time.sleep(0.25)
        self.fail("the node does not come up: " + "".join(open(log).read()[-500:] for log in glob.glob(f"{self.cluster}/*.log")))

    def test_an_array_bakes_one_asset_a_task(self):
        def bake_all(fails):
            self.run_program("sbatch", "--wait", f"--array=1-{COUNT}", "--output=task-%a.log", "slurm-array.sh",
                             env=self.environment, status=2 if fails else 0)

        self.check_failure_and_restart(bake_all)
        with open(self.path("task-1.log")) as f:
            self.assertIn("is up to date", f.read(), "the second array bakes what failed and nothing else")


if __name__ == "__main__":
    main()
