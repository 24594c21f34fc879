#!/usr/bin/env python3
"""How large the parts of the library are: longest functions, members of classes, public headers and what stands behind them.

  tools/structure.py [--check] [--all] [--root FOLDER]

Prints a row per folder of src/: its longest function and its largest class; then the public headers with the number of
headers of this project that each includes, directly or not; then the libraries that each component links. --all lists every
function and class that is over its limit. --check exits with 1 where a limit below is passed.

The code is read as text: comments, strings and preprocessor lines are blanked, and every brace is told from what stands
before it. That is right for code in the style of this repository; tests/tools/structure_test.py holds the cases.
"""
import argparse
import pathlib
import re
import sys

# The limits, all of them. Folders: where functions and classes are held to them.
FOLDERS = ["odometry", "graph", "slam"]
LONGEST_FUNCTION = 60  # lines, from its first line to its closing brace
MOST_MEMBERS = 12      # data members of a `class`; a `struct` is plain data and only printed
MOST_PUBLIC_HEADERS = 20  # but for those of live and localize
MOST_LIVE_HEADERS = 4
MOST_LOCALIZE_HEADERS = 2
MOST_BEHIND = {"match/scan_matcher.hpp": 8}  # headers of ours that a public header pulls in

LITERALS = re.compile(r'R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'')
COMMENTS = re.compile(r"//[^\n]*|/\*(?:.|\n)*?\*/")
NOT_MEMBERS = re.compile(r"(?:using|typedef|friend|static|static_assert|template|enum|extern|namespace)\b")
AFTER_PARAMETERS = {"const", "override", "noexcept", "final", "mutable", "try"}


def blank(found):
    """The same number of lines, and nothing on them that a scan for braces could take for code."""
    return re.sub(r"[^\n]", " ", found[0])


def code_of(text):
    text = re.sub(LITERALS.pattern + "|" + COMMENTS.pattern, lambda m: blank(m) if m[0][0] == "/" else '""' + blank(m)[2:], text)
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, text, flags=re.M)


def without_templates(text):
    """Drops <...>, innermost first; comparisons do not occur where this is asked."""
    text = text.replace("->", "  ").replace("<<", "  ").replace("<=>", "   ")
    while True:
        fewer = re.sub(r"<[^<>;{}]*>", "", text)
        if fewer == text:
            return text
        text = fewer


def kind_of(head, inside):
    """What an opening brace begins: namespace, class, struct, enum, function or values."""
    head = re.sub(r"\[\[[^\]]*\]\]", "", head).strip()
    plain = without_templates(re.sub(r"^(?:(?:public|private|protected)\s*:\s*)+", "", head)).strip()
    plain = re.sub(r"^template\s*", "", plain)
    if inside in ("function", "values", "enum"):
        return "values"
    if re.match(r"(?:inline\s+)?namespace\b", plain) or plain.startswith('extern ""'):
        return "namespace"
    if re.match(r"enum\b", plain):
        return "enum"
    found = re.match(r"(class|struct|union)\b(?![^:]*\()", plain)
    if found and "=" not in plain:
        return "class" if found[1] == "class" else "struct"
    before_parameters = plain.split("(")[0]
    if "(" not in plain or (re.search(r"(?<![=!<>])=(?!=)", before_parameters) and "operator" not in before_parameters):
        return "values"
    last = re.search(r"([\w:]+|\S)\s*$", plain)
    before = re.search(r"(\S)\s*[\w:]+\s*$", plain)
    if last and re.match(r"\w", last[1]) and last[1] not in AFTER_PARAMETERS and before and before[1] in ",:" and ")" in plain:
        return "values"  # member{...} of a constructor's list
    return "function"


def name_of(head, kind):
    head = without_templates(re.sub(r"^(?:(?:public|private|protected)\s*:\s*)+", "", head.strip()))
    if kind in ("class", "struct"):
        found = re.match(r"(?:template\s*)?(?:class|struct|union)\s+(?:alignas\([^)]*\)\s*)?([\w:]*)", head)
        return (found[1] if found else "") or "(unnamed)"
    found = re.search(r"(~?[\w:]+|operator\s*[^\s(]+(?:\(\))?)\s*\(", head)
    return found[1] if found else head[:40]


def members_of(statement):
    """How many data members a statement of a class declares."""
    statement = re.sub(r"^(?:\s*(?:public|private|protected)\s*:)+", "", statement).strip()
    statement = re.sub(r"\[\[[^\]]*\]\]|\balignas\([^)]*\)", "", statement).strip()
    if not statement or NOT_MEMBERS.match(statement):
        return 0
    if re.match(r"(?:class|struct|union)\b", statement):
        return 1 if re.search(r"\{\}\s*\w+", statement) else 0
    plain = without_templates(statement)
    declared = re.split(r"(?<![=!<>])=(?!=)", plain)[0]
    if "(" in declared or "operator" in declared:
        return 0
    depth, names = 0, 1
    for letter in plain:
        depth += letter in "({["
        depth -= letter in ")}]"
        names += letter == "," and depth == 0
    return names


def scan(path):
    """(functions, classes) of a file: lists of (size, name, line)."""
    code = code_of(path.read_text())
    functions, classes = [], []
    stack = []  # of [kind, name, first line, members, parentheses open outside]
    head, head_line, line, parentheses = "", 0, 1, 0
    for letter in code:
        if letter == "\n":
            line += 1
        if letter in "()":
            parentheses += 1 if letter == "(" else -1
        inside = stack[-1][0] if stack else "namespace"
        if letter == "{":
            kind = "values" if parentheses else kind_of(head, inside)
            stack.append([kind, name_of(head, kind), head_line, 0, parentheses, head, head_line])
            head, parentheses = "", 0
        elif letter == "}":
            kind, name, first, members, parentheses, outer, outer_line = stack.pop()
            if kind == "function":
                functions.append((line - first + 1, name, first))
            elif kind in ("class", "struct"):
                classes.append((members, name, first, kind))
            # A function's or namespace's brace ends the statement, that of values goes on with it.
            head, head_line = ("", 0) if kind in ("function", "namespace") else (outer + "{}", outer_line)
        elif letter == ";" and parentheses == 0:
            if inside in ("class", "struct"):
                stack[-1][3] += members_of(head)
            head = ""
        else:
            if not head.strip() and letter.strip():
                head, head_line = "", line
            head += letter
            if head.strip() in ("public:", "private:", "protected:"):
                head = ""
    if stack:
        raise ValueError(f"{path}: braces do not match; the last one open is of line {stack[-1][2]}")
    return functions, classes


def resolve(root, name):
    for base in (root / "include", root / "src"):
        if (base / name).is_file():
            return base / name
    return None


def behind(root, path):
    """Headers of this project that a header includes, directly or not."""
    seen, to_read = set(), [path]
    while to_read:
        reading = to_read.pop()
        for name in re.findall(r'^\s*#\s*include\s+["<]([^">]+)[">]', reading.read_text(), re.M):
            found = resolve(root, name)
            if found and found not in seen and found != path:
                seen.add(found)
                to_read.append(found)
    return seen


def links(root):
    """{component: [libraries that its target links and that are not targets of ours]}, of the build's files."""
    found = {}
    for path in [root / "src/CMakeLists.txt", *sorted((root / "cmake").glob("*.cmake"))]:
        text = re.sub(r"#[^\n]*", "", path.read_text())
        for target, words in re.findall(r"target_link_libraries\(\s*(phasescan\w*)\s+([^()]*)\)", text):
            if "${" in words:
                continue
            known = found.setdefault(target, ([], []))
            for word in words.split():
                if word in ("PUBLIC", "PRIVATE", "INTERFACE"):
                    continue
                word = re.sub(r"\$<BUILD_INTERFACE:(.*)>", r"\1", word)
                known[1 if word.startswith("phasescan") else 0].append(word)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="exit 1 where a limit is passed")
    parser.add_argument("--all", action="store_true", help="every function and class over its limit")
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    options = parser.parse_args()
    root = options.root
    over = []
    print(f"{'folder':12} {'longest function':52} {'largest class':34} largest struct")
    for folder in sorted(p for p in (root / "src").iterdir() if p.is_dir()):
        functions, classes = [], []
        for base in (folder, root / "include/phasescan" / folder.name):
            for path in sorted(base.rglob("*.[chi][pn][pc]")) if base.is_dir() else []:
                found = scan(path)
                where = path.relative_to(root)
                functions += [(*f, where) for f in found[0]]
                classes += [(*c, where) for c in found[1]]
        held = folder.name in FOLDERS
        for size, name, line, where in sorted(functions, reverse=True):
            if size > LONGEST_FUNCTION:
                (over if held else []).append(f"{where}:{line}: {name} has {size} lines, at most {LONGEST_FUNCTION}")
        for size, name, line, kind, where in sorted(classes, reverse=True):
            if size > MOST_MEMBERS and kind == "class":
                (over if held else []).append(f"{where}:{line}: {name} has {size} members, at most {MOST_MEMBERS} and a state struct")
        longest = max(functions, default=(0, "-", 0, ""))
        largest = [max((c for c in classes if c[3] == kind), default=(0, "-", 0)) for kind in ("class", "struct")]
        print(f"{folder.name:12} {longest[0]:4} {longest[1][:46]:47} {largest[0][0]:3} {largest[0][1]:30} {largest[1][0]:3} {largest[1][1]}")

    public = sorted((root / "include/phasescan").rglob("*.hpp"))
    print(f"\npublic headers: {len(public)}; headers of ours behind each:")
    of_live = sum(header.parent.name == "live" for header in public)
    of_localize = sum(header.parent.name == "localize" for header in public)
    for what, count, most in (("public headers", len(public) - of_live - of_localize, MOST_PUBLIC_HEADERS),
                              ("public headers of live", of_live, MOST_LIVE_HEADERS),
                              ("public headers of localize", of_localize, MOST_LOCALIZE_HEADERS)):
        if count > most:
            over.append(f"{count} {what}, at most {most}")
    for path in public:
        name = path.relative_to(root / "include/phasescan").as_posix()
        pulled = behind(root, path)
        private = [p for p in pulled if root / "src" in p.parents]
        print(f"  {name:36} {len(pulled):3}" + (f"   {len(private)} of them private" if private else ""))
        if len(pulled) > MOST_BEHIND.get(name, len(pulled)):
            over.append(f"{name} pulls in {len(pulled)} headers of ours, at most {MOST_BEHIND[name]}")
        if private:
            over.append(f"{name} includes private headers, first {sorted(p.name for p in private)[0]}")
    for name in MOST_BEHIND:
        if not (root / "include/phasescan" / name).is_file():
            over.append(f"{name} is no public header any more: change MOST_BEHIND")

    print("\nlibraries that each component links (besides those of the components it stands on):")
    for target, (others, ours) in sorted(links(root).items()):
        print(f"  {target:20} {' '.join(dict.fromkeys(others)) or '-'}" + (f"   on {' '.join(dict.fromkeys(ours))}" if ours else ""))
    if over:
        print(f"\n{len(over)} over the limits" + (":" if options.all or options.check else " (--all lists them)"))
        for line in over if options.all or options.check else []:
            print(f"  {line}")
    return 1 if options.check and over else 0


if __name__ == "__main__":
    sys.exit(main())
