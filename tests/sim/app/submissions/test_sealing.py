"""A sealed split is made from a secret, and only the sealed split passes for it."""

from __future__ import annotations

import json
import re
import stat
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands.seal import announce, make, publish, reveal
from sim.app.submissions import announcement, sealing
from sim.core.errors import ConfigError
from sim.core.reading import sha256_of
from sim.episodes.splits import load_split
from sim.homes.housegen.splits.recipes import Recipe
from tests.helpers import wording
from tests.helpers.submissions import tiny_split

STUDIO = Recipe(name="studio", seed=0, pool="heldout", kind="studio", area_m2=55.0)
SECRET, OTHER = "0123456789abcdef" * 4, "0123456789abcdee" * 4


def test_a_published_split_is_revealed_by_its_folder_and_a_changed_one_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    split = tiny_split(tmp_path)
    assert publish.main(publish.Args(split=split)) == 0
    seal = tmp_path / "tiny.sealed.json"
    assert reveal.main(reveal.Args(seal=seal, split=split)) == 0
    assert "'tiny' is the sealed split: 1 house, 3 episodes." in capsys.readouterr().out
    with pytest.raises(ConfigError, match=wording.IT_MAY_BE_A_SEAL_THAT_WAS_PUBLISHED):
        publish.main(publish.Args(split=split))
    secret = tmp_path / "secret"
    secret.write_text(SECRET)
    with pytest.raises(ConfigError, match=wording.THE_SEAL_OF_HOUSES_WITHOUT_A_SECRET_GIVE_THEIR_F):
        reveal.main(reveal.Args(seal=seal, secret_file=secret, out=tmp_path / "made" / "tiny"))
    house = split / "sofa_room.xml"
    house.write_text(house.read_text().replace("2.5", "2.4", 1))
    with pytest.raises(ConfigError, match="'tiny'"):
        reveal.main(reveal.Args(seal=seal, split=split))


@pytest.mark.parametrize("change", [{"houses": 2}, {"episodes": 4}])
def test_a_seal_with_other_counts_is_of_no_split(tmp_path: Path, change: dict[str, Any]) -> None:
    split, seal = tiny_split(tmp_path), tmp_path / "tiny.sealed.json"
    publish.main(publish.Args(split=split))
    seal.write_text(json.dumps(json.loads(seal.read_text()) | change))
    with pytest.raises(ConfigError, match=wording.IT_HAS_1_HOUSES_AND_3_EPISODES_THE_SEAL_SAYS_2_A):
        reveal.main(reveal.Args(seal=seal, split=split))


@pytest.mark.parametrize("change", [{"houses": 10**12}, {"episodes": 10**12}, {"houses": 0}])
def test_a_seal_of_more_houses_than_anybody_can_make_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    split, seal = tiny_split(tmp_path), tmp_path / "tiny.sealed.json"
    publish.main(publish.Args(split=split))
    seal.write_text(json.dumps(json.loads(seal.read_text()) | change))
    with pytest.raises(ConfigError, match=rf"field '{next(iter(change))}': expected int"):
        reveal.main(reveal.Args(seal=seal, split=split))
    with pytest.raises(ConfigError, match=rf"--{next(iter(change))}: expected int"):
        make.main(make.Args(out=tmp_path / "new", secret_file=tmp_path / "secret", **change))
    assert not (tmp_path / "secret").exists()


def test_a_sealed_split_is_for_its_owner_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(make, "make_split", lambda folder, *_, **__: load_split(tiny_split(folder)))
    out = tmp_path / "new"
    assert make.main(make.Args(out=out, secret_file=tmp_path / "secret")) == 0
    assert out.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("how", ["here", "link"])
def test_a_seal_lies_next_to_the_folder_itself_however_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    monkeypatch.setattr(make, "make_split", lambda folder, *_, **__: load_split(tiny_split(folder)))
    folder = tmp_path / "splits" / "new"
    folder.mkdir(parents=True)
    (tmp_path / "link").symlink_to(folder)
    monkeypatch.chdir(folder)
    out = Path() if how == "here" else tmp_path / "link"
    assert make.main(make.Args(out=out, secret_file=tmp_path / "secret")) == 0
    assert (tmp_path / "splits" / "new.sealed.json").is_file()


def test_a_folder_of_the_user_stays_when_revealing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(folder: Path, *_: object, **__: object) -> None:
        (folder / "half.xml").write_text("")
        raise ConfigError("The disk is full.")

    monkeypatch.setattr(reveal, "make_split", broken)
    seal, secret, out = tmp_path / "tiny.sealed.json", tmp_path / "secret", tmp_path / "empty" / "tiny"
    announcement.write_published(seal, sealing.seal_of(load_split(tiny_split(tmp_path)), SECRET), "a seal")
    secret.write_text(SECRET)
    out.mkdir(parents=True)
    with pytest.raises(ConfigError, match="The disk is full"):
        reveal.main(reveal.Args(seal=seal, secret_file=secret, out=out))
    assert out.is_dir()
    assert not list(out.iterdir())


def test_the_hash_of_a_secret_does_not_hold_it_and_a_new_one_is_for_its_owner_only(tmp_path: Path) -> None:
    file = tmp_path / "secret"
    secret = sealing.new_secret(file)
    assert sealing.read_secret(file) == secret
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert secret not in sealing.digest_of(secret)
    with pytest.raises(ConfigError, match=wording.IT_MAY_BE_THE_SECRET_OF_ANOTHER_SPLIT):
        sealing.new_secret(file)
    with pytest.raises(FileExistsError, match="secret"):
        sealing.new_secret(file / "below")


@pytest.mark.parametrize("text", ["", "abc", "0" * 63, "g" * 64, "0" * 2000, "0" * 64, "01" * 32])
def test_what_is_no_secret_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "secret").write_text(text)
    with pytest.raises(ConfigError, match=wording.HOLDS_NO_SECRET_IS_TOO_LARGE):
        sealing.read_secret(tmp_path / "secret")


@pytest.mark.parametrize(
    "change", [{"format": "x"}, {"split_sha256": "0"}, {"extra": 1}, {"houses": -1}, {"name": "a\nb"}, {"made_with": 3}]
)
def test_a_seal_of_another_form_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    publish.main(publish.Args(split=tiny_split(tmp_path)))
    file = tmp_path / "tiny.sealed.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | change))
    with pytest.raises(ConfigError, match="Seal '"):
        sealing.read_seal(file)


def test_another_secret_or_another_name_is_refused_before_houses_are_made(tmp_path: Path) -> None:
    announcement.write_published(
        tmp_path / "tiny.sealed.json", sealing.seal_of(load_split(tiny_split(tmp_path)), OTHER), "a seal"
    )
    seal, secret = tmp_path / "tiny.sealed.json", tmp_path / "secret"
    secret.write_text(SECRET)
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"secret_file": secret, "out": tmp_path / "other"}, "a folder named 'tiny'"),
        ({"secret_file": secret, "out": tmp_path / "made" / "tiny"}, "is not the sealed one"),
        ({}, "--announced FILE"),
    )
    for options, sentence in cases:
        with pytest.raises(ConfigError, match=sentence):
            reveal.main(reveal.Args(seal=seal, **options))


def test_houses_of_different_secrets_differ_and_are_no_shipped_ones() -> None:
    seeds = {next(sealing.recipes(secret, "s", house)).seed for secret in ("a", "b") for house in range(10)}
    assert len(seeds) == 20
    assert min(seeds) >= sealing.FIRST_SEED > max(sealed.seed for of in sealing.SPLITS.values() for sealed in of)


@pytest.mark.slow
def test_a_split_made_again_from_its_secret_is_the_sealed_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sealing, "SPLITS", {"test": (STUDIO,)})
    args = make.Args(out=tmp_path / "sealed", secret_file=tmp_path / "secret", houses=1, episodes=2)
    assert make.main(args) == 0
    again = reveal.Args(
        seal=tmp_path / "sealed.sealed.json", secret_file=tmp_path / "secret", out=tmp_path / "again" / "sealed"
    )
    assert reveal.main(again) == 0
    seal = tmp_path / "sealed.sealed.json"
    seal.write_text(json.dumps(json.loads(seal.read_text()) | {"split_sha256": "0" * 64, "made_with": {"mujoco": "1"}}))
    capsys.readouterr()
    for _ in range(2):  # what was made is removed, so that the next try begins as the first one
        with pytest.raises(ConfigError, match="Other versions: mujoco 1 there"):
            reveal.main(replace(again, out=tmp_path / "third" / "sealed"))
    assert "Made with another version: mujoco 1 there" in capsys.readouterr().out
    with pytest.raises(ConfigError, match=wording.IS_NOT_EMPTY):
        make.main(args)


BEACON = "c0ffee" + "0" * 34


def announced(tmp_path: Path, **changes: Any) -> Path:
    """Returns the announcement of a split of one house."""
    options: dict[str, Any] = {"agent_commit": "a" * 40, "beacon": "the first commit of tomorrow", "houses": 1}
    options |= {"episodes": 2} | changes
    assert announce.main(announce.Args(out=tmp_path / "mine", **options)) == 0
    return tmp_path / "mine.announced.json"


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"agent_commit": "HEAD"}, "--agent-commit must be 40 hexadecimal digits.*'HEAD'"),
        ({"beacon": "soon"}, "beacon"),
        ({"beacon_by": "me"}, "beacon_by"),
    ],
)
def test_an_announcement_without_a_commit_or_a_rule_is_refused(
    tmp_path: Path, change: dict[str, Any], part: str
) -> None:
    with pytest.raises(ConfigError, match=part):
        announced(tmp_path, **change)


def test_the_secret_of_an_announced_split_depends_on_the_announcement_and_on_the_beacon(tmp_path: Path) -> None:
    digest = sha256_of(announced(tmp_path), what="Announcement")
    secrets = {announcement.secret_of(digest, BEACON), announcement.secret_of(digest, "0" * 40)}
    secrets.add(announcement.secret_of("0" * 64, BEACON))
    assert len(secrets) == 3


@pytest.mark.slow
def test_an_announced_split_is_made_from_the_beacon_and_again_by_everybody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sealing, "SPLITS", {sealing.LIKE: (STUDIO,)})
    file = announced(tmp_path, beacon_by="authors")
    options: dict[str, Any] = {"out": tmp_path / "mine", "announced": file}
    with pytest.raises(ConfigError, match="--beacon"):
        make.main(make.Args(**options, beacon="tomorrow"))
    assert make.main(make.Args(**options, beacon=BEACON)) == 0
    split, seal = load_split(tmp_path / "mine"), tmp_path / "mine.sealed.json"
    assert sealing.origin_of(split, tmp_path / "mine") == "authors"
    again = tmp_path / "again" / "mine"
    assert reveal.main(reveal.Args(seal=seal, announced=file, out=again)) == 0
    assert load_split(again).sha256 == split.sha256
    assert "The authors could choose the beacon" in capsys.readouterr().out
    other = announced(tmp_path / "other")
    with pytest.raises(ConfigError, match=re.escape(str(other))):
        reveal.main(reveal.Args(seal=seal, announced=other, out=tmp_path / "third" / "mine"))


def git(folder: Path, *words: str) -> str:
    named = ("-c", "user.name=A", "-c", "user.email=a@b.c")
    return subprocess.run(
        ["git", "-C", str(folder), *named, *words], check=True, capture_output=True, text=True
    ).stdout.strip()


def committed(folder: Path, file: Path) -> str:
    git(folder, "add", str(file))
    git(folder, "commit", "-qm", file.name)
    return git(folder, "rev-parse", "HEAD")


def test_the_order_of_the_commits_is_agent_announcement_beacon_seal(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    agent, seal = tmp_path / "agent.py", tmp_path / "mine.sealed.json"
    agent.write_text("pass")
    seal.write_text("{}")
    file = announced(tmp_path, agent_commit=committed(tmp_path, agent))
    with pytest.raises(ConfigError, match=re.escape(str(file))):
        announcement.faults_of_order(file, seal, BEACON, tmp_path)
    committed(tmp_path, file)
    later = tmp_path / "later.txt"
    later.write_text("tomorrow")
    beacon = committed(tmp_path, later)
    committed(tmp_path, seal)
    assert announcement.faults_of_order(file, seal, beacon, tmp_path) == []
    assert announcement.faults_of_order(file, seal, BEACON, tmp_path) == []
    assert len(announcement.faults_of_order(file, file, beacon, tmp_path)) == 1  # committed before the beacon
    agent_commit = announcement.read_announcement(file).agent_commit
    assert len(announcement.faults_of_order(file, seal, agent_commit, tmp_path)) == 1  # the beacon was there before
    file.write_text(file.read_text() + " ")
    committed(tmp_path, file)
    with pytest.raises(ConfigError, match=re.escape(str(file))):
        announcement.faults_of_order(file, seal, beacon, tmp_path)
