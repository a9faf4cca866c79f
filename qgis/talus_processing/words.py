"""What the program says is wrong, in the words of a dialog: it knows options and keys, its user sees fields."""

import re


def in_words_of_dialog(text, named):
    """`named`: what the dialog calls something, by what the program calls it."""
    text = re.sub(r"; see talus [a-z ]+ --help$", "", text.removeprefix("new scene: "))
    # A key with a field of its own was set by nobody's line: "--set KEY=VALUE: KEY = VALUE is refused".
    own = re.match(r"--set ([\w.\[\]]+)=.*?: (?=\1 )", text)
    if own and own.group(1) in named:
        text = text[own.end() :]
    if not named:
        return text
    # The longest first; what goes on with a letter or a hyphen is another word.
    words = "|".join(re.escape(word) for word in sorted(named, key=len, reverse=True))
    return re.sub(rf"(?<![\w./-])(?:{words})(?![\w-])", lambda found: named[found.group()], text)
