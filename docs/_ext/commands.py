"""The directive ``commands``: every command of the program, from the words that ``--help`` prints."""

from __future__ import annotations

import inspect

import docstring_parser
from sphinx.util.docutils import SphinxDirective

from spheredrive.cli import app


def command_names() -> list[str]:
    """Every command, in the order in which the program lists them in its source."""
    return [name for name in app if not name.startswith("-")]


def command_page(name: str) -> str:
    """One command in Markdown: what it does, how it is called, and what may be said to it."""
    command = app[name]
    words = docstring_parser.parse(inspect.getdoc(command.default_command) or "")
    said = {parameter.arg_name: " ".join((parameter.description or "").split()) for parameter in words.params}
    arguments = [argument for argument in command.assemble_argument_collection() if argument.show]
    text = f"## {name}\n\n{words.description}\n\n```text\n{_usage(name, arguments)}\n```\n"
    return text + "".join(f"\n{_shown(argument)}\n: {_meaning(argument, said)}\n" for argument in arguments)


def _usage(name: str, arguments) -> str:
    words = [_word(argument) for argument in arguments if _positional(argument)]
    needed = [f"{argument.names[-1]} …" for argument in arguments if not _positional(argument) and argument.required]
    options = ["[options]"] if any(not _positional(a) and not a.required for a in arguments) else []
    return " ".join(["spheredrive", name, *words, *needed, *options])


def _word(argument) -> str:
    name = argument.field_info.name.upper()
    name = f"{name}…" if argument.field_info.kind.name == "VAR_POSITIONAL" else name
    return name if argument.required else f"[{name}]"


def _positional(argument) -> bool:
    return argument.field_info.kind.name in ("POSITIONAL_ONLY", "POSITIONAL_OR_KEYWORD", "VAR_POSITIONAL")


def _shown(argument) -> str:
    if _positional(argument):
        return f"`{_word(argument).strip('[]')}`"
    # cyclopts gives every list an --empty-…, which nobody needs to read of.
    return ", ".join(f"`{name}`" for name in argument.names if not name.startswith("--empty-"))


def _meaning(argument, said: dict[str, str]) -> str:
    words = said.get(argument.field_info.name) or argument.parameter.help or "—"
    default = argument.field_info.default
    if argument.required or default in (None, False, True, argument.field_info.empty):
        return words
    return f"{words} `{default}` if absent."


class Commands(SphinxDirective):
    """``commands``: a section for each command."""

    def run(self):
        """The sections."""
        text = "\n".join(command_page(name) for name in command_names())
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app):
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True}
