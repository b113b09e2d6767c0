"""Files of weights: valid files load, and others are refused with a message."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import safetensors.torch
import torch

from sim.core.interface import ConfigError
from stubborn.network_files import read_checkpoint, read_weights
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from tests.helpers import wording

TINY = RedNetConfig(width=4, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


@pytest.fixture(scope="module")
def published_state() -> dict[str, torch.Tensor]:
    """Returns an invented checkpoint of the published network: every tensor is filled with a number by its index."""
    with torch.device("meta"):
        shapes = {name: (tensor.shape, tensor.dtype) for name, tensor in RedNet().state_dict().items()}
    values = ((name, shape, dtype, i) for i, (name, (shape, dtype)) in enumerate(shapes.items()))
    return {name: torch.tensor(i % 7, dtype=dtype).expand(shape) for name, shape, dtype, i in values}


@pytest.mark.costly
def test_a_checkpoint_in_the_published_wrapper_loads_into_the_published_network(
    published_state: dict[str, torch.Tensor], tmp_path: Path
) -> None:
    file = tmp_path / "rednet_semmap_mp3d_40.pth"
    torch.save({"model_state": {f"module.{name}": value for name, value in published_state.items()}}, file)
    model, _ = load_network(file)
    loaded = model.state_dict()
    assert list(loaded) == list(published_state)
    assert all(bool((loaded[name] == published_state[name]).all()) for name in loaded)
    assert not model.training


def test_a_different_shape_is_refused_with_its_name(published_state: dict[str, torch.Tensor], tmp_path: Path) -> None:
    wrong = dict(published_state)
    wrong["layer2.0.conv1.weight"] = torch.zeros(128, 255, 1, 1)
    wrong["out2_conv_custom.bias"] = torch.zeros(21)
    torch.save(wrong, tmp_path / "wrong.pth")
    with pytest.raises(ConfigError, match=r"'layer2\.0\.conv1\.weight' is \(128, 255, 1, 1\), not \(128, 256, 1, 1\)"):
        load_network(tmp_path / "wrong.pth")


def test_a_missing_and_an_unknown_name_are_refused(published_state: dict[str, torch.Tensor], tmp_path: Path) -> None:
    missing = {name: value for name, value in published_state.items() if name != "agant3.1.bias"}
    torch.save(missing, tmp_path / "missing.pth")
    with pytest.raises(ConfigError, match=r"'agant3\.1\.bias' is missing"):
        load_network(tmp_path / "missing.pth")
    torch.save({**published_state, "head.weight": torch.zeros(1)}, tmp_path / "foreign.pth")
    with pytest.raises(ConfigError, match=r"'head\.weight'"):
        load_network(tmp_path / "foreign.pth")


class _Malicious:
    def __reduce__(self) -> tuple:
        return (Path.touch, (Path("/tmp/a-pickle-was-run"),))


def test_pickled_code_is_not_run(tmp_path: Path) -> None:
    torch.save({"model_state": _Malicious()}, tmp_path / "evil.pth")
    with pytest.raises(ConfigError, match="PyTorch"):
        load_network(tmp_path / "evil.pth")
    assert not Path("/tmp/a-pickle-was-run").exists()


@pytest.mark.parametrize("name", ["broken.pth", "broken.safetensors"])
def test_a_broken_file_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"not weights at all")
    with pytest.raises(ConfigError, match=f"{name}' cannot be read"):
        load_network(tmp_path / name)


def test_a_truncated_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "net.safetensors"
    save_network(file, RedNet(TINY))
    file.write_bytes(file.read_bytes()[:-100])
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        load_network(file)


def test_weights_have_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    save_network(tmp_path / "net.safetensors", RedNet(TINY))
    (tmp_path / "other").touch()
    assert (tmp_path / "net.safetensors").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"No weights at '.*nowhere\.pth'"):
        load_network(tmp_path / "nowhere.pth")


def test_a_saved_network_loads_with_the_same_size_and_weights(tmp_path: Path) -> None:
    torch.manual_seed(1)
    model = RedNet(TINY).half().float().eval()  # 16 bits hold its numbers
    save_network(tmp_path / "net.safetensors", model, {"temperature": 1.25, "command": "none"})
    loaded, metadata = load_network(tmp_path / "net.safetensors")
    rgb, depth = torch.randn(1, 3, 32, 64), torch.randn(1, 1, 32, 64)
    assert loaded.config == TINY
    assert metadata == {"temperature": 1.25, "command": "none"}
    with torch.inference_mode():
        assert torch.equal(model(rgb, depth), loaded(rgb, depth))


@pytest.mark.parametrize("dtype", [torch.float16, torch.float32])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30])
def test_weights_without_meaning_are_refused_by_name(value: float, dtype: torch.dtype, tmp_path: Path) -> None:
    file, model = tmp_path / "net.safetensors", RedNet(TINY)
    save_network(file, model)
    tensors, header = read_weights(file)
    assert tensors["conv1.weight"].dtype is torch.float16
    tensors["conv1.weight"] = tensors["conv1.weight"].to(dtype)
    tensors["conv1.weight"][0, 0, 0, 0] = value
    safetensors.torch.save_file(tensors, file, metadata={key: json.dumps(each) for key, each in header.items()})
    with pytest.raises(ConfigError, match=r"'conv1\.weight'.*NaN.*1e\+12"):
        load_network(file)
    with torch.no_grad():
        model.get_parameter("conv1.weight")[0, 0, 0, 0] = value
    with pytest.raises(ConfigError, match=r"'conv1\.weight'"):
        save_network(file, model)  # 1e30 is infinite in 16 bits


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ({"rednet_config": {"width": 4096}}, "of another network: 'conv1.weight' is"),
        ({"rednet_config": {"width": 10**9}}, "a size of 1000000000, at most 4096"),
        ({"rednet_config": {"width": "wide"}}, "field 'width': expected int, got str"),
        ({"rednet_config": {"depth": 4}}, "field 'depth' is unknown"),
        ({"rednet_config": 7}, "expected object, got int"),
        ({"rednet_config": {"encoder_blocks": [0, 1, 1, 1]}}, "at least one channel"),
        ({"poni_config": {"widths": [8]}}, "of another network: 'conv1.weight' is"),
        ({"block_px": 0}, "header, field 'block_px': expected int >= 1"),
        ({"block_px": "x"}, "field 'block_px'"),
        ({"temperature": -1.0}, "field 'temperature'"),
        ({"calibration": {"scale": []}}, "field 'calibration': object missing required field offset"),
        ({"calibration": 3}, "field 'calibration'"),
    ],
)
def test_a_header_that_is_wrong_or_asks_for_too_much_is_refused(
    header: dict[str, object], message: str, tmp_path: Path
) -> None:
    safetensors.torch.save_file(
        {"conv1.weight": torch.zeros(1)},
        tmp_path / "net.safetensors",
        metadata={key: json.dumps(value) for key, value in header.items()},
    )
    with pytest.raises(ConfigError, match=re.escape(message)):
        load_network(tmp_path / "net.safetensors")


def test_a_checkpoint_may_hold_numpy_numbers_next_to_its_tensors(tmp_path):
    metrics = {"best": np.float64(0.41), "epoch": np.int64(3), "half": np.float16(0.5), "done": np.bool_(True)}
    torch.save(metrics | {"model": {"w": torch.zeros(2)}}, tmp_path / "w.pth")
    assert read_checkpoint(tmp_path / "w.pth")["best"] == 0.41
