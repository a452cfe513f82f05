# SPDX-License-Identifier: MIT
"""How long is each function of a source? By braces for C and C++, by the parser for Python, by indentation for JavaScript.

A function counts from the line of its name to that of its closing brace, as its reader does.
"""

import ast
import re

COMMENT_OR_LITERAL = re.compile(r"//[^\n]*|/\*.*?\*/|'(?:\\.|[^'\\\n])*'|R\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"", re.DOTALL)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.)*", re.MULTILINE | re.DOTALL)
ATTRIBUTE = re.compile(r"__attribute__\s*\(\((?:[^()]|\([^()]*\))*\)\)")
TOKEN = re.compile(r"[{};]")
NAMED_SCOPE = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b[^()=]*$")
# What may stand before a parenthesis without being the function's name.
NOT_A_NAME = ("alignas", "noexcept", "decltype", "_Alignas")


def blanked(text):
    """The text with comments, literals, directives and attributes replaced by spaces; lines stay where they are."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group())
    return ATTRIBUTE.sub(spaces, DIRECTIVE.sub(spaces, COMMENT_OR_LITERAL.sub(spaces, text)))


def function_name(head):
    """(name, its position) if the text before a brace declares a function; None for initialisers and lists."""
    for found in re.finditer(r"(~?\w+|operator\s*\S+)\s*\(", head):
        if found.group(1) not in NOT_A_NAME:
            return (found.group(1), found.start()) if "=" not in head[: found.start()] else None
    return None


def closing(text, start):
    """Where the brace that opens at start is closed; the end of the text if nowhere."""
    depth = 0
    for found in re.finditer(r"[{}]", text[start:]):
        depth += 1 if found.group() == "{" else -1
        if depth == 0:
            return start + found.start()
    return len(text)


def c_functions(text):
    """(name, first line, last line) of each function with a body, methods and those in namespaces included."""
    text, at, begin, found = blanked(text), 0, 0, []
    while token := TOKEN.search(text, at):
        at = token.end()
        if token.group() == "{":
            head = text[begin : token.start()]
            named = None if NAMED_SCOPE.search(head) else function_name(head)
            if named:
                at = closing(text, token.start()) + 1
                found.append((named[0], text.count("\n", 0, begin + named[1]) + 1, text.count("\n", 0, at) + 1))
            elif not NAMED_SCOPE.search(head):
                at = closing(text, token.start()) + 1
        begin = at
    return found


def python_functions(text):
    return [(node.name, node.lineno, node.end_lineno) for node in ast.walk(ast.parse(text))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def javascript_functions(text):
    found, lines = [], text.splitlines()
    head = re.compile(r"^(\s*)(?:export |default |async |static |function |get |set )*(\w+)\s*\(.*\) \{$")
    for number, line in enumerate(lines):
        begins = head.match(line)
        if begins and begins.group(2) not in ("if", "for", "while", "switch", "catch"):
            end = next((n for n in range(number + 1, len(lines)) if lines[n].startswith(begins.group(1) + "}")), number)
            found.append((begins.group(2), number + 1, end + 1))
    return found


def functions(path, text):
    if path.endswith((".c", ".h", ".cpp")):
        return c_functions(text)
    if path.endswith(".py"):
        return python_functions(text)
    return javascript_functions(text) if path.endswith(".mjs") else []
