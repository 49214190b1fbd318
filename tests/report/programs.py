"""Runs hairbake's programs and remembers the command lines."""
import json
import shlex
import subprocess
import sys
import time
from pathlib import Path


class Hairbake:
    """hairbake, run from `root`. Every command line is noted in `commands` until it is taken."""

    def __init__(self, root, program):
        self.root, self.program, self.commands, self.baked = root, program, [], {}

    def run(self, *arguments, allowed=(0,)):
        """Standard output of one run; the report ends when its exit code is none of `allowed`."""
        words = [self.program, *map(str, arguments)]
        line = shlex.join(words)
        self.commands.append(line)
        print(f"[{time.strftime('%H:%M:%S')}] {line}", flush=True)
        done = subprocess.run(words, cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if done.returncode not in allowed:
            sys.exit(f"{line}\nended with exit code {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def take_commands(self):
        """The command lines since the last call."""
        taken, self.commands = self.commands, []
        return taken

    def bake(self, folder, hair=None, env=None, **fields):
        """Bakes into `folder` and gives the manifest. `fields` are request fields with "__" for the dot. A folder is
        baked once; asked for again, its command line is noted again."""
        words = ["bake"]
        for flag, path in (("--hair", hair), ("--env", env)):
            words += [flag, path] if path else []
        for name, value in fields.items():
            words += ["--set", f"{name.replace('__', '.')}={value}"]
        words += ["--outputs", "npy", "--out", folder]
        if self.baked.setdefault(str(folder), words) != words:
            sys.exit(f"{folder} is asked for twice with different settings")
        if not (self.root / folder / "manifest.json").exists():
            self.run(*words)
        else:
            self.commands.append(shlex.join([self.program, *map(str, words)]))
        return json.loads((self.root / folder / "manifest.json").read_text(encoding="utf-8"))

    def seconds(self, stage, folder, hair=None, env=None, **fields):
        """Wall time of a stage, the best of three bakes into `folder`-0 to -2."""
        return min(self.bake(f"{folder}-{run}", hair, env, **fields)["timings_s"][stage] for run in range(3))

    def render(self, name, *arguments):
        """Renders name.exr and name.png; gives `name`."""
        if not (self.root / f"{name}.exr").exists():
            self.run("render", *arguments, "--out", f"{name}.exr", "--out", f"{name}.png")
        return name

    def diff(self, first, second, scale=None):
        """Figures of second - first, with the false-colour picture's name as "picture"."""
        picture = f"{second}-minus-{Path(first).name}.png"
        words = ["diff", "--json", f"{first}.exr", f"{second}.exr", "--out", picture]
        figures = json.loads(self.run(*words, *(["--scale", scale] if scale else [])))
        return {**figures, "picture": picture}

    def compare(self, first, second):
        """Differences of two result folders."""
        return json.loads(self.run("compare", "--json", first, second, allowed=(0, 1)))


def hardware():
    """Processor, its number of cores, memory."""
    facts = {}
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition(":")
        if name.strip() == "model name":
            facts["processor"] = value.strip()
            facts["cores"] = facts.get("cores", 0) + 1
    memory = Path("/proc/meminfo").read_text(encoding="utf-8").split("MemTotal:")[1].split()[0]
    return f"{facts.get('processor', 'unknown processor')}, {facts.get('cores', '?')} cores, {int(memory) / 1048576:.0f} GiB"
