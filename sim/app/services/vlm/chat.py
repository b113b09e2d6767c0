"""Questions to an OpenAI-compatible chat endpoint (`POST URL/chat/completions`), as vLLM, ollama and llama.cpp have it.

A reply counts if its text is one JSON object of the declared type; anything else, code for example, is an error.
Nothing in a reply is carried out. Replies are kept as those of all services are (`sim.app.services.client`): with a
cache, a repeated episode asks the same questions, gets the same replies and needs no server.
"""

from __future__ import annotations

import base64
import json
import os
import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from sim.app.services.client import JSON, Client, ServiceConfig
from sim.app.services.vlm.pictures import jpeg
from sim.core.errors import AgentError, ConfigError
from sim.core.reading import Count, parse_json, printable

T = TypeVar("T")
MAX_CHARACTERS = 20_000
"""Longest text of a reply."""
_FENCED = re.compile(r"\A```(?:json)?\s*\n(.*)\n```\Z", re.DOTALL)
_THOUGHTS = re.compile(r"\A\s*<think>.*?</think>", re.DOTALL)
"""The thoughts that some models put before their answer."""


@dataclass(frozen=True, kw_only=True)
class ChatConfig(ServiceConfig):
    """How a language model is asked."""

    url: str = "http://localhost:11434/v1"
    """Address of the endpoint without `/chat/completions`; the default is that of ollama on this machine."""
    timeout_s: float = 60.0
    """Longest time of one request."""
    model: str = ""
    """Name of the model at the server."""
    temperature: float | None = 0.0
    """Sampling temperature; None: the request does not state one."""
    max_tokens: int | None = 400
    """Longest reply; None: the request does not state it."""
    key_variable: str = "OPENAI_API_KEY"
    """Environment variable with the key of the server. The key is not recorded."""
    input_price: float = 0.0
    """Price of a million tokens of questions, in any currency."""
    output_price: float = 0.0
    """Price of a million tokens of replies."""


class _Usage(msgspec.Struct):
    prompt_tokens: Count = 0
    completion_tokens: Count = 0


class _Message(msgspec.Struct):
    content: Annotated[str, Meta(max_length=MAX_CHARACTERS)]


class _Choice(msgspec.Struct):
    message: _Message
    finish_reason: str | None = None


class _Completion(msgspec.Struct):
    choices: Annotated[list[_Choice], Meta(min_length=1)]
    usage: _Usage | None = None


class Chat:
    """Asks one model, and counts what an episode takes.

    Args:
        config: how it is asked.
        system: the text that precedes each question.
    """

    def __init__(self, config: ChatConfig, system: str) -> None:
        key = os.environ.get(config.key_variable, "")
        self._config, self._system = config, system
        self._client = Client(config, {"Authorization": f"Bearer {key}"} if key else {})
        self.begin()

    def begin(self) -> None:
        """Starts to count for a new episode."""
        self.questions = self.failed = self.prompt_tokens = self.completion_tokens = 0
        self.wait_s = 0.0

    @property
    def cost(self) -> float:
        """Cost of the episode so far, in the currency of the prices."""
        config = self._config
        return 1e-6 * (self.prompt_tokens * config.input_price + self.completion_tokens * config.output_price)

    def ask(self, text: str, pictures: Sequence[NDArray[np.uint8]], kind: type[T]) -> T:
        """Returns the reply to a question.

        Args:
            text: the question.
            pictures: (h, w, 3) RGB; the model gets them as JPEG.
            kind: type of the JSON object that the reply must be.

        Raises:
            AgentError: there was no valid reply.
        """
        began_s = time.perf_counter()
        try:
            url = f"{self._config.url.rstrip('/')}/chat/completions"
            reply, usage = self._client.ask(url, self._body(text, pictures), JSON, _reader(kind))
        except AgentError:
            self.failed += 1
            raise
        finally:
            self.wait_s += time.perf_counter() - began_s
        self.questions += 1
        self.prompt_tokens += usage.prompt_tokens
        self.completion_tokens += usage.completion_tokens
        return reply

    def _body(self, text: str, pictures: Sequence[NDArray[np.uint8]]) -> bytes:
        content: list[dict[str, Any]] = [{"type": "text", "text": text}]
        for picture in pictures:
            address = f"data:image/jpeg;base64,{base64.b64encode(jpeg(picture)).decode()}"
            content.append({"type": "image_url", "image_url": {"url": address}})
        messages = [{"role": "system", "content": self._system.strip()}, {"role": "user", "content": content}]
        options = {"temperature": self._config.temperature, "max_tokens": self._config.max_tokens}
        stated = {name: value for name, value in options.items() if value is not None}
        return json.dumps({"model": self._config.model, "messages": messages, **stated}).encode()


def _reader(kind: type[T]) -> Callable[[bytes], tuple[T, _Usage]]:
    """Returns a reader of replies whose text is a JSON object of a type."""

    def read(data: bytes) -> tuple[T, _Usage]:
        completion = parse_json(data, _Completion, where="its reply")
        choice = completion.choices[0]
        if choice.finish_reason == "length":
            raise ConfigError("its reply was cut off at max_tokens.")
        text = _THOUGHTS.sub("", choice.message.content).strip()
        fenced = _FENCED.match(text)
        begin = printable(" ".join(text[:200].split()))[:60]
        reply = parse_json(fenced[1] if fenced else text, kind, where=f"the model's text '{begin}'")
        return reply, completion.usage or _Usage()

    return read
