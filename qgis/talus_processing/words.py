"""What the program says is wrong, in the words of a dialog: it knows options and keys, its user sees fields."""

import re


def in_words_of_dialog(text, named):
    """`named`: what the dialog calls something, by what the program calls it."""
    text = re.sub(r"; see talus [a-z ]+ --help$", "", text.removeprefix("new scene: "))
    # The longest first; what goes on with a letter, a hyphen or a key's point is another word.
    words = "|".join(re.escape(word) for word in sorted(named, key=len, reverse=True))
    return re.sub(rf"(?<![\w./-])(?:{words})(?![\w-])", lambda found: named[found.group()], text) if named else text
