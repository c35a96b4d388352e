"""Power cuts: what a disk may hold after each prefix of the log that inject.c writes of a run.

The model of the disk is that of a careless file system. What was written to a file and not followed by fsync() of it may be
there, partly there, or not. Names that were given or taken and not followed by fsync() of the folder: any of these changes
may have happened, whatever the others."""
import itertools
import os
from dataclasses import dataclass

from jobs import OLD


@dataclass
class File:
    content: bytes
    is_safe: bool  # all of it was flushed


class Disk:
    def __init__(self, names, folder):
        self.safe_names = {name: File(content, True) for name, content in names.items()}
        self.names = dict(self.safe_names)  # as the running program sees them
        self.pending = []                   # changes of names: dictionaries of the names that change
        self.open_files = {folder: None}    # by inode

    def change_names(self, changes):
        self.names.update(changes)
        self.pending.append(changes)

    def apply(self, line):
        words = line.split()
        if words[0] == "create":
            file, name = File(b"", False), os.path.basename(words[2])
            self.open_files[words[1]] = file
            self.change_names({name: file})
        elif words[0] == "write":
            file = self.open_files[words[1]]
            file.content += bytes.fromhex(words[2])
            file.is_safe = False
        elif words[0] == "fsync":
            self.flush(self.open_files[words[1]])
        elif words[0] == "rename":
            source, target = map(os.path.basename, words[1:])
            self.change_names({target: self.names[source], source: None})
        elif words[0] == "unlink":
            self.change_names({os.path.basename(words[1]): None})

    def flush(self, file):
        if file:
            file.is_safe = True
            return
        self.safe_names, self.pending = dict(self.names), []

    def after_cut(self):
        """All that the folder may hold if power fails now."""
        for happened in itertools.product((False, True), repeat=len(self.pending)):
            names = dict(self.safe_names)
            for changes, has_happened in zip(self.pending, happened):
                names.update(changes if has_happened else {})
            yield names


def state_of(judge, name, file, has_old):
    if file is None:
        return "broken" if has_old else "old"
    if not file.is_safe:
        return "broken"
    if file.content == OLD:
        return "old"
    return "new" if judge.is_new(name, file.content) else "broken"


def faults_of_cut(judge, names, has_old, is_done):
    states = {name: state_of(judge, name, names.get(name), has_old) for name in judge.job.outputs}
    wrong = [f"{name} is neither old nor new" for name, state in states.items() if state == "broken"]
    for name, state in states.items():
        asset = name.replace("a.stamp", "a.pliant").removesuffix(".stamp")
        if name.endswith(".stamp") and state == "new" and states[asset] != "new":
            wrong.append("the stamp is new and its asset is not")
    if is_done and any(state != "new" for state in states.values()):
        wrong.append("the tool has ended and an output is not new")
    return wrong


def replay(judge, place, lines):
    """(number of states, {what is wrong: numbers of lines after which})"""
    has_old = any(name in place.initial for name in judge.job.outputs)
    disk = Disk(place.initial, str(os.stat(place.folder).st_ino))
    found, count = {}, 0
    for number, line in enumerate(lines, 1):
        disk.apply(line)
        for names in disk.after_cut():
            count += 1
            for text in faults_of_cut(judge, names, has_old, number == len(lines)):
                found.setdefault(text, set()).add(number)
    return count, {text: sorted(numbers) for text, numbers in found.items()}
