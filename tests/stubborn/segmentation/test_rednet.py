"""The network: names and shapes of the published one, sizes of its outputs, folding, gradients."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from sim.core.interface import ConfigError
from stubborn.segmentation.rednet import COMPACT, PUBLISHED, RedNet, RedNetConfig, as_functions, folded

NAMES_AND_SHAPES = Path(__file__).with_name("rednet_state_dict.txt")


def shape_text(tensor: torch.Tensor) -> str:
    return "x".join(map(str, tensor.shape)) or "scalar"


@pytest.fixture(scope="module")
def published() -> RedNet:
    with torch.device("meta"):
        return RedNet(PUBLISHED)


def test_the_published_network_has_81972552_parameters(published: RedNet) -> None:
    assert sum(parameter.numel() for parameter in published.parameters()) == 81_972_552


def test_names_and_shapes_are_those_of_the_published_checkpoints(published: RedNet) -> None:
    lines = NAMES_AND_SHAPES.read_text(encoding="utf-8").splitlines()
    wanted = [tuple(line.split()) for line in lines if line and not line.startswith("#")]
    assert [(name, shape_text(tensor)) for name, tensor in published.state_dict().items()] == wanted


@pytest.mark.parametrize("config", [PUBLISHED, COMPACT], ids=["published", "compact"])
def test_outputs_have_five_scales(config: RedNetConfig) -> None:
    with torch.device("meta"):
        outputs = RedNet(config).eval().pyramid(torch.zeros(2, 3, 480, 640), torch.zeros(2, 1, 480, 640))
    assert [tuple(out.shape) for out in outputs] == [
        (2, 40, 480, 640),
        (2, 40, 240, 320),
        (2, 40, 120, 160),
        (2, 40, 60, 80),
        (2, 40, 30, 40),
    ]


def test_sizes_that_are_not_multiples_of_32_are_refused() -> None:
    with pytest.raises(ConfigError, match="multiples of 32"):
        RedNet(COMPACT)(torch.zeros(1, 3, 240, 320), torch.zeros(1, 1, 240, 320))


def test_the_output_depends_on_colour_and_on_depth() -> None:
    torch.manual_seed(0)
    model = RedNet(RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1)))
    model.eval()
    rgb, depth = torch.zeros(1, 3, 64, 64), torch.zeros(1, 1, 64, 64)
    with torch.inference_mode():
        plain, coloured, deep = model(rgb, depth), model(rgb + 1, depth), model(rgb, depth + 1)
    assert not torch.allclose(plain, coloured)
    assert not torch.allclose(plain, deep)
    assert not torch.allclose(coloured, deep)


@pytest.mark.parametrize("bottleneck", [False, True])
def test_folding_changes_neither_the_outputs_nor_the_model(bottleneck: bool) -> None:
    torch.manual_seed(1)
    blocks = (2, 1, 1, 1)
    model = RedNet(RedNetConfig(width=8, encoder_blocks=blocks, bottleneck=bottleneck, decoder_blocks=blocks)).eval()
    for module in model.modules():
        if isinstance(module, torch.nn.BatchNorm2d):  # as if it had been trained
            for tensor in (module.weight.data, module.bias.data, module.running_mean, module.running_var):
                assert tensor is not None
                tensor.uniform_(0.5, 1.5)
    rgb, depth = torch.randn(1, 3, 64, 96), torch.randn(1, 1, 64, 96)
    with torch.inference_mode():
        before, fast = model(rgb, depth), folded(model)(rgb, depth)
        assert torch.equal(model(rgb, depth), before)
    assert before.std() > 0
    assert torch.allclose(fast, before, rtol=0, atol=1e-4 * float(before.abs().max()))
    assert not any(isinstance(module, torch.nn.BatchNorm2d) for module in folded(model).modules())


@pytest.mark.parametrize("bottleneck", [False, True])
def test_a_network_of_functions_gives_the_same_outputs(bottleneck: bool) -> None:
    torch.manual_seed(2)
    blocks = (1, 2, 1, 1)
    config = RedNetConfig(
        width=8, encoder_blocks=blocks, bottleneck=bottleneck, decoder_blocks=blocks, names=("chair", "stool")
    )
    model = folded(RedNet(config).eval())
    rgb, depth = torch.randn(1, 3, 64, 96), torch.randn(1, 1, 64, 96)
    with torch.inference_mode():
        logits, (stages, _) = model(rgb, depth), model.features(rgb, depth)
        assert model.names_head is not None
        names = model.names_head(stages)
        fast = as_functions(model)
        assert list(fast.modules()) == [fast]
        assert logits.std() > 0
        assert torch.equal(fast(rgb, depth), logits)
        assert torch.equal(fast.names_head(fast.features(rgb, depth)[0]), names)  # pyright: ignore[reportOptionalCall]


def test_every_parameter_has_a_gradient_from_the_five_outputs() -> None:
    torch.manual_seed(0)
    model = RedNet(RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1)))
    outputs = model.pyramid(torch.randn(2, 3, 64, 64), torch.randn(2, 1, 64, 64))
    sum(out.square().mean() for out in outputs).backward()  # type: ignore[union-attr]
    without = [name for name, p in model.named_parameters() if p.grad is None or not p.grad.abs().sum() > 0]
    assert without == []
