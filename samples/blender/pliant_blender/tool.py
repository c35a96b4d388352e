"""The tool pliant as a child process: its progress, its messages word for word, and its end."""
import os
import re
import shutil
import subprocess
import time

import bpy

from .shapes import Failure

PROGRESS = re.compile(r"pliant [\w-]+: (?P<stage>[^:]+?) (?P<percent>\d+) %(?P<left>, [^(]* left)?.*")
MESSAGE = re.compile(r"pliant(?: [\w-]+)?: ((error|warning) P\d{4}: .*)")


def find():
    """The path that the preferences name, or the program of that name on PATH."""
    name = bpy.path.abspath(bpy.context.preferences.addons[__package__].preferences.tool)
    path = shutil.which(name)
    if not path:
        raise Failure(f"the tool '{name}' was not found: set its path in the preferences of the add-on")
    return os.path.abspath(path)  # it runs in other folders


class Run:
    """Commands of the tool, one after another, in a folder. Their standard error is a terminal, so that the tool draws its
    progress all the time and not only at the start of a stage."""

    def __init__(self, commands, folder):
        self.commands, self.folder, self.program = list(commands), folder, find()
        self.stage, self.percent, self.messages, self.code = "", 0, [], None
        self.start()

    def start(self):
        self.rest = b""
        self.terminal, other_end = os.openpty()
        os.set_blocking(self.terminal, False)
        try:
            self.process = subprocess.Popen([self.program, *self.commands.pop(0)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                            stdout=subprocess.DEVNULL, stderr=other_end)
        finally:
            os.close(other_end)

    def poll(self):
        """Takes what the tool has said. The exit code after the last command, or after one that wrote nothing; else None."""
        code = self.process.poll()
        self.read()
        if code is None or self.code is not None:
            return self.code
        if self.commands and code in (0, 4):  # 4: the asset is there, and misses the tolerance
            self.start_next()
        else:
            self.code = code
        return self.code

    def start_next(self):
        os.close(self.terminal)
        try:
            self.start()
        except OSError as error:  # the program has gone since the last command
            self.messages.append(str(error))
            self.code = 1

    def wait(self):
        while self.poll() is None:
            time.sleep(0.02)
        return self.code

    def read(self):
        try:
            while True:
                self.rest += os.read(self.terminal, 65536)
        except OSError:  # nothing more yet, or ever
            pass
        *lines, self.rest = re.split(rb"[\r\n]+", self.rest.replace(b"\x1b[K", b""))
        for line in [*lines, self.rest]:
            self.take_progress(line.decode("utf-8", "replace"))
        for line in lines:
            self.take_message(line.decode("utf-8", "replace"))

    def take_progress(self, line):
        found = PROGRESS.fullmatch(line)
        if found:
            self.stage = found["stage"] + (found["left"] or "")
            self.percent = max(self.percent, int(found["percent"]))  # a second command starts at 0

    def take_message(self, line):
        found = MESSAGE.fullmatch(line)
        if found:
            self.messages.append(found[1])
        elif line.startswith("  ") and self.messages:
            self.messages[-1] += "\n" + line

    def stop(self):
        """The tool writes whole files or none, so that it may be ended at any time."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        os.close(self.terminal)
