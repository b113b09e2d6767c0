"""The names of `sim` and their modules, for type checkers and for `lazy_loader`."""

from .core.configuration import with_fields as with_fields
from .core.errors import ConfigError as ConfigError
from .core.errors import HouseError as HouseError
from .core.errors import ObjectNavError as ObjectNavError
from .core.geometry.pose import Pose as Pose
from .core.goals import GoalSpec as GoalSpec
from .core.goals import PictureCamera as PictureCamera
from .core.interface import GOAL_CATEGORIES as GOAL_CATEGORIES
from .core.interface import MPCAT40 as MPCAT40
from .core.interface import MPCAT40_ID as MPCAT40_ID
from .core.interface import Action as Action
from .core.interface import Agent as Agent
from .core.interface import AgentSpec as AgentSpec
from .core.interface import CameraModel as CameraModel
from .core.interface import Observation as Observation
from .core.interface import RobotModel as RobotModel
from .core.interface import Scores as Scores
from .core.interface import SegmentationSpec as SegmentationSpec
from .core.interface import Segmenter as Segmenter
from .core.interface import SegmenterSpec as SegmenterSpec
from .core.interface import SuccessRule as SuccessRule
from .env.objectnav import ObjectNavEnv as ObjectNavEnv
from .episodes.episode import Episode as Episode
from .episodes.splits import load_split as load_split
from .homes.housegen.config import HouseConfig as HouseConfig
from .homes.housegen.furniture import CATALOGUE as CATALOGUE
from .homes.housegen.furniture.catalogue import Style as Style
from .homes.housegen.furniture.workbench import Workbench as Workbench
from .homes.housegen.generator import generate as generate
from .houses.load import load_house as load_house
from .houses.writing import house_text as house_text
from .houses.writing import write_house as write_house
from .robot.foreign import load_robot as load_robot
from .sensors.noise import NoiseConfig as NoiseConfig
from .sensors.sensor import Sensor as Sensor
from .sensors.sensor import SensorContext as SensorContext
from .task.trajectory import read_trajectory as read_trajectory
from .training.segmentation.dataset import LabelledView as LabelledView
from .training.segmentation.dataset import ViewDataset as ViewDataset

__all__ = [
    "CATALOGUE",
    "GOAL_CATEGORIES",
    "MPCAT40",
    "MPCAT40_ID",
    "Action",
    "Agent",
    "AgentSpec",
    "CameraModel",
    "ConfigError",
    "Episode",
    "GoalSpec",
    "HouseConfig",
    "HouseError",
    "LabelledView",
    "NoiseConfig",
    "ObjectNavEnv",
    "ObjectNavError",
    "Observation",
    "PictureCamera",
    "Pose",
    "RobotModel",
    "Scores",
    "SegmentationSpec",
    "Segmenter",
    "SegmenterSpec",
    "Sensor",
    "SensorContext",
    "Style",
    "SuccessRule",
    "ViewDataset",
    "Workbench",
    "generate",
    "house_text",
    "load_house",
    "load_robot",
    "load_split",
    "read_trajectory",
    "with_fields",
    "write_house",
]
