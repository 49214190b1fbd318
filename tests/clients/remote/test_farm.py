"""The recipes of clients/farm, run as a farm runs them."""
import json
import os
import subprocess
import unittest
from pathlib import Path

from rig import PROGRAMS, QUICK, ROOT, LastingDaemon, Workshop, first_word
from harness import hair_bytes, hdr_bytes

FARM = ROOT / "clients/farm"


class Farm(unittest.TestCase):
    def setUp(self):
        self.shop = Workshop([])
        self.addCleanup(self.shop.folder.cleanup)
        self.shop.environment["PATH"] = f"{self.shop.path / 'bin'}:{PROGRAMS}:{os.environ['PATH']}"
        self.hair = self.shop.write("groom.hair", hair_bytes())
        self.sky = self.shop.write("sky.hdr", hdr_bytes())

    def test_the_step_of_a_build_farm_leaves_the_result_and_can_be_repeated(self):
        with LastingDaemon() as daemon:
            self.shop.environment["HAIRBAKE_SERVER"] = f"http://127.0.0.1:{daemon.port}"
            step = ["sh", str(FARM / "bake_step.sh"), self.hair, self.sky, "out", *QUICK]
            for _ in range(2):
                self.shop.command = step
                done = self.shop.run()
                self.assertEqual(done.code, 0, done)
                self.assertEqual(len(done.out.splitlines()), 1)
                bake = json.loads(self.shop.files("out")["manifest.json"])["id"]
                self.assertEqual(first_word(done.out), bake)
                self.assertEqual(self.shop.files("out")["transmittance.npy"], daemon.file(bake, "transmittance.npy"))
            # It fails as hairbake does: a broken groom is exit code 8.
            self.shop.command[2] = self.shop.write("broken.hair", hair_bytes()[:200])
            self.assertEqual(self.shop.run().code, 8)

    def test_the_step_says_what_is_missing(self):
        self.shop.command = ["sh", str(FARM / "bake_step.sh")]
        self.assertEqual(self.shop.run(self.hair).code, 2)
        self.assertIn("HAIRBAKE_SERVER", self.shop.run(self.hair, self.sky, "out").err)

    def slurm(self, task, *words):
        """The script's body as slurmd runs it, with an srun that notes its own flags and runs the rest."""
        self.shop.environment.update(SLURM_ARRAY_TASK_ID=str(task), SLURM_CPUS_PER_TASK="2")
        return self.shop.run(*words)

    def test_the_slurm_script_bakes_a_groom_a_task(self):
        (self.shop.path / "bin").mkdir()
        srun = Path(self.shop.write("bin/srun", b'#!/bin/sh\necho "$@" >>srun.log\n'
                                                b'while [ "${1#--}" != "$1" ]; do shift; done\nexec "$@"\n'))
        srun.chmod(0o755)
        (self.shop.path / "grooms").mkdir()
        self.shop.write("grooms/a.hair", hair_bytes())
        self.shop.write("grooms/b.hair", hair_bytes(seed=9))
        self.shop.command = ["bash", str(FARM / "bake.slurm"), "grooms", self.sky, "baked", *QUICK]
        for task in (1, 2):
            done = self.slurm(task)
            self.assertEqual(done.code, 0, done)
        here = [PROGRAMS / "hairbake", "bake", "--hair", self.shop.path / "grooms/b.hair", "--env", self.sky, "--out",
                self.shop.path / "here", *QUICK]
        subprocess.run(here, check=True, capture_output=True)
        a, b, expected = (self.shop.files(folder)["transmittance.npy"] for folder in ("baked/a", "baked/b", "here"))
        self.assertEqual(b, expected)
        self.assertNotEqual(a, expected)
        log = (self.shop.path / "srun.log").read_text().splitlines()
        self.assertEqual(len(log), 2)
        self.assertIn("--ntasks=1 --cpus-per-task=2", log[0])
        self.assertIn("--threads 2", log[0])
        # Again: what is there stays, and a task too many says so.
        self.assertEqual(self.slurm(1).code, 0)
        self.assertEqual(len((self.shop.path / "srun.log").read_text().splitlines()), 2)
        self.assertEqual(self.slurm(3).code, 2)


if __name__ == "__main__":
    unittest.main()
