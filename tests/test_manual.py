# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# Manual pages and shell completions, as the tools that use them see them:
# test_manual.py RUGA BUILD_DIR SOURCE_DIR [unittest arguments]. What needs a program that is not there is skipped.
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

RUGA, BUILD, SOURCE = (os.path.abspath(path) for path in sys.argv[1:4])
PARTS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES", "SEE ALSO"]
MACROS = {".TH", ".SH", ".TP", ".PP", ".B", ".I", ".BR", ".RI", ".RS", ".RE", ".EX", ".EE"}


def output(*command, **more):
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, **more)
    assert done.returncode == 0, (command, done.returncode, done.stderr)
    return done.stdout


def commands():
    """Names of the commands and their help."""
    listed = output(RUGA, "--help").split("\ncommands:\n")[1].split("\n\n")[0]
    return {name: output(RUGA, name, "--help") for name in re.findall(r"^    (\w+)", listed, re.M)}


def options(about):
    """(letter or "", name, what it takes or "") of each option in the help of a command."""
    table = about.split("\noptions:\n")[1].split("\n\nexample:")[0]
    return re.findall(r"^    (?:(-\w), )?(--[\w-]+)(?: (\S+))?", table, re.M)


def need(program):
    if not shutil.which(program):
        raise unittest.SkipTest(f"{program} is not installed")


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.commands = commands()
        cls.folder = tempfile.mkdtemp(prefix="ruga_manual_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        output(RUGA, "manual", "-o", "share", "--quiet", cwd=cls.folder)
        cls.share = os.path.join(cls.folder, "share")
        for name in ("a.yaml", "b.h5", "c.obj", "d.txt", "e.png"):
            with open(os.path.join(cls.folder, name), "w", encoding="utf-8"):
                pass
        os.mkdir(os.path.join(cls.folder, "folder"))

    def pages(self):
        folder = os.path.join(self.share, "man", "man1")
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), encoding="ascii") as file:
                yield os.path.join(folder, name), file.read()


class Manual(Case):
    def test_every_command_has_a_page(self):
        self.assertEqual({os.path.basename(path) for path, _ in self.pages()},
                         {"ruga.1"} | {f"ruga-{name}.1" for name in self.commands})

    def test_pages_have_the_usual_parts_and_macros_only(self):
        for path, text in self.pages():
            parts = [part.strip('"') for part in re.findall(r"^\.SH (.*)$", text, re.M)]
            self.assertEqual([part for part in parts if part != "COMMANDS"], PARTS, path)
            self.assertRegex(text, r'\A\.\\" .*\n\.TH "RUGA[A-Z\\-]*" 1 "" "Ruga [\d.]+" "Ruga"\n\.SH NAME\nruga.* \\- .')
            for line in text.splitlines():
                if line.startswith((".", "'")) and not line.startswith('.\\"'):
                    self.assertIn(line.split()[0], MACROS, path)
            self.assertEqual(text.count("\n.EX\n"), text.count("\n.EE\n"), path)
            self.assertEqual(text.count("\n.RS"), text.count("\n.RE"), path)

    def test_pages_say_what_the_help_says(self):
        def plain(text):
            text = re.sub(r"\\f[BIR]", "", text).replace("\\&", "").replace("\\e", "\\").replace("\\-", "-")
            for name, sign in (("aq", "'"), ("ga", "`"), ("ha", "^"), ("ti", "~"), ("dq", '"')):
                text = text.replace("\\(" + name, sign)
            return " ".join(re.sub(r"^\.\w+ ?", "", text, flags=re.M).split())

        for name, about in self.commands.items():
            with open(os.path.join(self.share, "man", "man1", f"ruga-{name}.1"), encoding="ascii") as file:
                page = plain(file.read())
            for line in about.splitlines():
                for piece in re.split(r"\s{2,}", line.strip()):
                    if not piece.startswith(("usage:", "options:", "example:")):
                        self.assertIn(" ".join(piece.split()), page, name)

    def test_man_groff_and_lexgrog_have_nothing_to_say(self):
        found = [tool for tool in ("groff", "man", "lexgrog", "mandoc") if shutil.which(tool)]
        if not found:
            raise unittest.SkipTest("none of groff, man, lexgrog and mandoc is installed")
        for path, _ in self.pages():
            if "groff" in found:
                done = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8", path], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), path)
            if "man" in found:
                done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", path], capture_output=True, text=True,
                                      env=dict(os.environ, MANROFFOPT="-ww", LC_ALL="C.UTF-8"))
                self.assertEqual((done.returncode, done.stderr), (0, ""), path)
            if "lexgrog" in found:
                self.assertIn(f'"{os.path.basename(path)[:-2]} - ', output("lexgrog", path))
            if "mandoc" in found:
                self.assertEqual(output("mandoc", "-T", "lint", "-W", "warning", path), "")

    def test_they_are_installed(self):
        prefix = os.path.join(self.folder, "prefix")
        output("cmake", "--install", BUILD, "--prefix", prefix)
        for folder, _, names in os.walk(self.share):
            for name in names:
                path = os.path.join(folder, name)
                with open(path, encoding="utf-8") as made, \
                        open(os.path.join(prefix, "share", os.path.relpath(path, self.share)), encoding="utf-8") as put:
                    self.assertEqual(made.read(), put.read())

    def test_every_choice_is_listed_in_its_option(self):
        for name in sorted(os.listdir(os.path.join(SOURCE, "app"))):
            if not name.endswith("_command.c"):
                continue
            with open(os.path.join(SOURCE, "app", name), encoding="utf-8") as file:
                text = file.read()
            command = re.search(r'\.name = "(\w+)"', text)[1]
            takes = {option: value for _, option, value in options(self.commands[command])}
            for option in re.findall(r'ruga_option_choice\([^,]*, "(--\w+)"', text):
                self.assertIn("|", takes[option], f"app/{name}: the value of {option} in its table of options is "
                                                  'no list "a|b|c"; name the array that ruga_option_choice gets')

    def test_a_place_that_cannot_be_made_is_refused(self):
        done = subprocess.run([RUGA, "manual", "-o", "a.yaml/share"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\Aruga: a.yaml is a file; a folder is needed here\n\Z")


class Completion:
    """What each shell offers; `complete` returns a set of words for the end of a command line."""

    def test_commands(self):
        self.assertLessEqual(set(self.commands), self.complete("ruga "))
        self.assertEqual(self.complete("ruga mea"), {"measure"})

    def test_options_of_each_command(self):
        for name, about in self.commands.items():
            wanted = {option for _, option, _ in options(about)}
            self.assertEqual({word.rstrip("=") for word in self.complete(f"ruga {name} --")}, wanted, name)

    def test_choices(self):
        for name, about in self.commands.items():
            for letter, option, takes in options(about):
                if "|" in takes and takes == takes.lower():
                    self.assertEqual(self.complete(f"ruga {name} {option} "), set(takes.split("|")), name)
        self.assertEqual(self.complete("ruga make pi"), {"pillow"})

    def test_files(self):
        self.assertEqual(self.complete("ruga run "), {"a.yaml", "folder", "share"})
        self.assertEqual(self.complete("ruga measure "), {"b.h5", "folder", "share"})
        self.assertEqual(self.complete("ruga check "), {"c.obj", "folder", "share"})
        self.assertEqual(self.complete("ruga render b.h5 -o "), {"e.png", "folder", "share"})
        self.assertEqual(self.complete("ruga sweep a.yaml -o "), {"folder", "share"})

    def test_keys_of_scenes(self):
        with open(os.path.join(SOURCE, "docs", "scene.md"), encoding="utf-8") as file:
            keys = {key for key, value in re.findall(r"^\| `([\w.]+)` \| ([^|]+) \|", file.read(), re.M)
                    if value.strip() not in ("a map", "a list of maps", "not available yet")}
        found = {word.split("=")[0] for word in self.complete("ruga run a.yaml --set ")}
        self.assertEqual(found, {key.replace(".N.", ".0.") for key in keys})
        self.assertEqual({word.split("=")[0] for word in self.complete("ruga run a.yaml --set skin.th")},
                         {"skin.thickness"})
        self.assertEqual({word.split("=")[0] for word in self.complete("ruga run a.yaml --set handles.3.fi")},
                         {"handles.3.fix"})
        self.assertEqual({word.split("=")[-1] for word in self.complete("ruga run a.yaml --set skin.membrane=s")},
                         {"stvk"})
        self.assertEqual({word.split("=")[-1] for word in self.complete("ruga run a.yaml --set coupling.foundation=t")},
                         {"true"})
        self.assertEqual({word.split("=")[-1] for word in self.complete("ruga run a.yaml --set handles.3.hold=i")},
                         {"interior"})


class Bash(Case, Completion):
    """The function is called as readline would call it, with the words that bash itself makes of the line."""
    SCRIPT = r"""
        source "$1/bash-completion/completions/ruga"
        COMP_LINE=$2
        # As bash does: blanks end words, = is a word of its own.
        line=${COMP_LINE//=/ = }
        read -ra COMP_WORDS <<< "$line"
        [[ $COMP_LINE == *" " ]] && COMP_WORDS+=("")
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMP_POINT=${#COMP_LINE}
        $(complete -p ruga | sed 's/.*-F \(\S*\) .*/\1/') ruga "${COMP_WORDS[-1]}" "${COMP_WORDS[-2]}"
        printf '%s\n' "${COMPREPLY[@]}" """

    @classmethod
    def setUpClass(cls):
        need("bash")
        super().setUpClass()

    def complete(self, line):
        found = output("bash", "--norc", "-c", self.SCRIPT, "bash", self.share, line, cwd=self.folder)
        return {word.rstrip("/") for word in found.split()} - {"-h", "-o"} if "--" in line.split(" ")[-1:] else \
            {word.rstrip("/") for word in found.split()}


class Fish(Case, Completion):
    @classmethod
    def setUpClass(cls):
        need("fish")
        super().setUpClass()

    def complete(self, line):
        found = output("fish", "--no-config", "-c", "source $argv[1]/fish/vendor_completions.d/ruga.fish\n"
                       "function ruga; end\ncomplete -C $argv[2]", self.share, line, cwd=self.folder,
                       env=dict(os.environ, HOME=self.folder))
        return {entry.split("\t")[0].rstrip("/") for entry in found.splitlines()}


class Zsh(Case, Completion):
    """An interactive zsh on a terminal of its own; what is offered is written down by compadd."""
    SETUP = r"""
        PROMPT='' RPROMPT='' fpath=($SHARE/zsh/site-functions $fpath)
        autoload -Uz compinit && compinit -u -D
        zstyle ':completion:*' list-dirs-first false
        compadd() {
            if [[ ${@[1,(i)(-|--)]} != *-(O|A|D)\ * ]]; then
                local -a hits
                builtin compadd -A hits "$@"
                print -rl -- $hits >> found
            fi
            builtin compadd "$@"
        }
        finish() { print done > finished; compstate[insert]= ; compstate[list]= }
        capture() { comppostfuncs=(finish); _main_complete }
        zle -C capture complete-word capture
        bindkey '^I' capture
        bindkey '^U' kill-whole-line
        print ready > finished
        """

    @classmethod
    def setUpClass(cls):
        need("zsh")
        super().setUpClass()
        with open(os.path.join(cls.folder, ".zshrc"), "w", encoding="utf-8") as file:
            file.write(cls.SETUP)
        cls.hidden = os.path.join(cls.folder, "finished")
        child, cls.terminal = pty.fork()
        if child == 0:
            os.chdir(cls.folder)
            os.execvpe("zsh", ["zsh", "-d", "-i"], dict(os.environ, ZDOTDIR=cls.folder, SHARE=cls.share, TERM="dumb"))
        cls.addClassCleanup(os.waitpid, child, 0)
        cls.addClassCleanup(os.kill, child, signal.SIGKILL)
        cls.wait()

    @classmethod
    def wait(cls):
        """Until the shell has written its file; what it prints meanwhile is read and dropped."""
        for _ in range(3000):
            if select.select([cls.terminal], [], [], 0.01)[0]:
                os.read(cls.terminal, 65536)
            elif os.path.exists(cls.hidden):
                os.remove(cls.hidden)
                return
        raise AssertionError("zsh does not answer")

    def complete(self, line):
        path = os.path.join(self.folder, "found")
        if os.path.exists(path):
            os.remove(path)
        os.write(self.terminal, b"\x15" + line.encode() + b"\t")
        self.wait()
        if not os.path.exists(path):
            return set()
        with open(path, encoding="utf-8") as file:
            found = {word.rstrip("/") for word in file.read().split("\n")} - {"", "found"}
        last = line.split(" ")[-1]
        return {word for word in found if word.startswith(last.split("=")[-1])} - ({"-h", "-o"} if last else set())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
