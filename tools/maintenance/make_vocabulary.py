"""Writes the words for objects (`sim/core/words/vocabulary.csv`) from WordNet 3.0 and a table of the makers' own.

    apt-get download wordnet-base && dpkg -x wordnet-base_*.deb /tmp/wordnet
    python -m tools.maintenance.make_vocabulary --wordnet /tmp/wordnet/usr/share/wordnet

`household_words.txt` says which synset each name of an object means, and adds words that WordNet does not have. The
lemmas of a synset are synonyms of the name; those of its hyponyms are kinds of it, and mean it too (a loveseat is a
sofa). Compounds that WordNet explains otherwise, such as "flower bed", are listed as words with another meaning, so
that a reader who takes the last word of a compound for its meaning does not take these.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from sim.app import cli
from sim.core.files import csv_text, write_atomically
from sim.core.vocabulary import FILE, normal_form
from sim.homes.housegen.furniture.names import CATEGORIES_OF_NAMES

TABLE = Path(__file__).with_name("household_words.txt")
_LAST_SENSE = 6
"""A word does not mean an object by a sense that WordNet lists after this one."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the words for objects."""

    wordnet: Path
    """Folder of WordNet's files data.noun and index.noun."""
    out: Path = FILE
    """The file."""


class Synset(NamedTuple):
    """A set of synonyms."""

    words: list[str]
    above: list[str]
    below: list[str]


class WordNet:
    """The nouns of WordNet (its manual pages `wndb` and `wninput` describe the files)."""

    def __init__(self, folder: Path) -> None:
        self.synsets: dict[str, Synset] = {}
        for line in (folder / "data.noun").read_text().splitlines():
            if line.startswith("  "):
                continue
            fields = line.partition("|")[0].split()
            count = int(fields[3], 16)
            words = [fields[4 + 2 * i].lower() for i in range(count)]
            rest = fields[5 + 2 * count :]
            pointers = [(rest[4 * i], rest[4 * i + 1]) for i in range(int(fields[4 + 2 * count]))]
            above = [offset for symbol, offset in pointers if symbol == "@"]
            self.synsets[fields[0]] = Synset(words, above, [offset for symbol, offset in pointers if symbol == "~"])
        self.senses: dict[str, list[str]] = {}
        for line in (folder / "index.noun").read_text().splitlines():
            if not line.startswith("  "):
                fields = line.split()
                self.senses[fields[0]] = fields[-int(fields[2]) :]

    def synset(self, name: str) -> str:
        """Returns the offset of `lemma.sense`."""
        lemma, _, sense = name.rpartition(".")
        return self.senses[lemma][int(sense) - 1]

    def below(self, offset: str) -> Iterator[tuple[str, int]]:
        """Yields a synset and all hyponyms with their distances, the nearest first."""
        queue, seen = deque([(offset, 0)]), {offset}
        while queue:
            at, distance = queue.popleft()
            yield at, distance
            for child in self.synsets[at].below:
                if child not in seen:
                    seen.add(child)
                    queue.append((child, distance + 1))


class Entry(NamedTuple):
    """A line of the table."""

    name: str
    synsets: list[str]
    words: list[str]


def main(args: Args) -> int:
    """Writes the file; returns the exit status."""
    wordnet = WordNet(args.wordnet)
    names, general, phrases = read_table()
    rows = [(name, "name", ";".join(categories)) for name, categories in sorted(CATEGORIES_OF_NAMES.items())]
    taken = set[str](CATEGORIES_OF_NAMES)
    anchors, own = anchors_of(names, wordnet), own_words(names)
    for word, (relation, means) in sorted({**words_of(anchors, general, wordnet), **own, **phrases}.items()):
        if word not in taken:
            rows.append((word, relation, ";".join(sorted(means))))
    write_atomically(args.out, csv_text(["word", "relation", "means"], rows))
    print(f"{args.out}: {len(rows)} words")
    return 0


def read_table() -> tuple[list[Entry], list[str], dict[str, tuple[str, set[str]]]]:
    """Returns the entries of names, the synsets of general words, and the phrases with their meanings."""
    names, general, phrases = [], [], dict[str, tuple[str, set[str]]]()
    for line in TABLE.read_text(encoding="utf-8").splitlines():
        line = line.partition("#")[0].strip()
        if line.startswith("^"):
            general += line[1:].split()
        elif line.startswith("="):
            phrase, _, means = line[1:].partition(":")
            parts = means.split() if "@" in means else [part.strip() for part in means.split(",")]
            phrases[normal_form(phrase)] = "phrase", set(parts)
        elif line:
            name, _, rest = line.partition(":")
            synsets, _, words = rest.partition(";")
            names.append(Entry(name, synsets.split(), [normal_form(word) for word in words.split(",") if word.strip()]))
    unknown = {entry.name for entry in names if not entry.name.startswith("@")} - set(CATEGORIES_OF_NAMES)
    if unknown:
        raise SystemExit(f"{TABLE}: no object has the name {sorted(unknown)[0]!r}.")
    return names, general, phrases


def own_words(names: list[Entry]) -> dict[str, tuple[str, set[str]]]:
    """Returns the words that WordNet does not have, with what they mean."""
    result: dict[str, tuple[str, set[str]]] = {}
    for entry in names:
        for word in entry.words:
            result.setdefault(word, ("synonym", set()))[1].add(entry.name)
    return result


def anchors_of(names: list[Entry], wordnet: WordNet) -> dict[str, tuple[int, set[str]]]:
    """Returns for each synset that means some names its distance from theirs, and the nearest names."""
    anchors: dict[str, tuple[int, set[str]]] = {}
    for entry in names:
        for synset in entry.synsets:
            for offset, distance in wordnet.below(wordnet.synset(synset.removeprefix("!"))):
                if distance and synset.startswith("!"):
                    break
                best, means = anchors.get(offset, (99, set()))
                if distance < best:
                    anchors[offset] = distance, {entry.name}
                elif distance == best:
                    means.add(entry.name)
    return anchors


def words_of(
    anchors: Mapping[str, tuple[int, set[str]]], general: list[str], wordnet: WordNet
) -> dict[str, tuple[str, set[str]]]:
    """Returns WordNet's words for objects with their relation and what they mean, and compounds with other meanings."""
    above: dict[str, set[str]] = {}
    for name in general:
        top = wordnet.synset(name)
        above[top] = {word for offset, _ in wordnet.below(top) for word in anchors.get(offset, (0, set()))[1]}
    result: dict[str, tuple[str, set[str]]] = {}
    for lemma, senses in wordnet.senses.items():
        word = normal_form(lemma.replace("_", " "))
        for offset in senses[:_LAST_SENSE]:
            if offset in anchors:
                distance, means = anchors[offset]
                result[word] = ("kind" if distance else "synonym"), means
                break
            if above.get(offset):
                result[word] = "general", above[offset]
                break
    plants = {offset for offset, _ in wordnet.below(wordnet.synset("plant.2"))}
    for lemma, senses in wordnet.senses.items():  # of the thousands of plants only those that are called one
        word = normal_form(lemma.replace("_", " "))
        if word.endswith(" plant") and word not in result and plants.intersection(senses):
            result[word] = "kind", {"@plant"}
    heads = {word for word in result if " " not in word}
    for lemma in wordnet.senses:
        word = normal_form(lemma.replace("_", " "))
        if " " in word and word not in result and word.rpartition(" ")[2] in heads:
            result[word] = "other", set()
    return result


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
