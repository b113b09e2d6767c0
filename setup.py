"""Packages the shipped houses of assets/ into the wheel as `sim/assets`; all else is in pyproject.toml."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["sim*", "stubborn*"]), "sim.assets"],
    py_modules=["stubborn_habitat"],
    package_dir={"sim.assets": "assets"},
    package_data={
        "sim.assets": ["mjcf_houses/**/*"],
        "sim.app.analysis.report": ["page/*"],
        "sim.app.bridges.ros2": ["files/**/*"],
        "sim.app.services.vlm": ["*.toml"],
        "sim.app.web": ["page/*"],
        "sim.core": ["words/*"],
        "sim.houses": ["*.csv"],
        "sim.robot": ["sidecars/*.json"],
        "sim": ["*.pyi", "py.typed"],
        "stubborn": ["*.pyi", "py.typed", "**/*.json", "**/*.npz", "**/*.safetensors"],
    },
)
