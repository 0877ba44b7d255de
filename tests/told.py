#!/usr/bin/python3
"""told.py [--calm] PAGE [HEADING]: what a page tells is what comes out.

Of the page, or of what stands below HEADING, every `$ command` in code is run in the folder where this
is called, in order, and must succeed (compare may find differences); lines that follow it there are
to come out of it in this order, `...` being any others, and at a line's end whatever follows. Blanks
count once. Code whose first line is `# NAME.yaml` is such a file. With --calm nothing may warn. Speaks TAP.
"""
import pathlib
import re
import subprocess
import sys


def told(page, heading):
    """Commands of the page, each with the lines that are told of it."""
    text = pathlib.Path(page).read_text(encoding="utf-8")
    if heading:
        level = re.search(rf"(?m)^(#+) {re.escape(heading)}$", text)
        text = re.split(rf"(?m)^#{{1,{len(level[1])}}} ", text[level.end():])[0]
    commands, inside = [], False
    for line in text.splitlines():
        inside = line.startswith("    ") and line.strip() != "" or inside and line.strip() == ""
        if not inside:
            continue
        if name := re.fullmatch(r"    # (\w+\.yaml)", line):
            commands.append([f"cat >{name[1]} <<'END'\n", []])
        if line.startswith("    $ "):
            commands.append([line[6:], []])
        elif commands and commands[-1][0].startswith("cat >"):
            commands[-1][0] += line[4:] + "\n"
        elif commands and commands[-1][0].endswith("\\"):
            commands[-1][0] = commands[-1][0][:-1] + line.strip()
        elif commands and commands[-1][0].count("'") % 2:
            commands[-1][0] += " " + line.strip()
        elif commands and line.strip() not in ("", "..."):
            commands[-1][1].append(line)
    return commands


def holds(lines, output):
    """The first line that does not follow in the output; None: all do."""
    rest = iter(" ".join(line.split()) for line in output.splitlines())
    for line in lines:
        wanted = " ".join(line.split())
        begin = wanted.removesuffix(" ...")
        if not any(said == wanted or begin != wanted and said.startswith(begin) for said in rest):
            return line
    return None


def main():
    calm = sys.argv[1] == "--calm"
    page, *heading = sys.argv[1 + calm:]
    commands = told(page, " ".join(heading))
    for number, (command, lines) in enumerate(commands, 1):
        script = command + "END\n" if command.startswith("cat >") else command
        done = subprocess.run(["bash", "-c", script], stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        missing = holds(lines, done.stdout)
        differs = done.returncode == 1 and " compare " in command
        warns = calm and "warning:" in done.stdout
        good = (done.returncode == 0 or differs) and missing is None and not warns
        print("ok" if good else "not ok", number, "-", command.splitlines()[0], flush=True)
        if not good:
            print(f"# exit code {done.returncode}, no line: {missing}\n# " +
                  done.stdout.replace("\n", "\n# "), flush=True)


if __name__ == "__main__":
    main()
