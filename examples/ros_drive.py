"""Drives a robot of ROS 2 to a place on its map, and calls its STOP. It imports nothing of this project.

    stubborn ros --map --ground-truth-tf --wait --only val_0000
    python examples/ros_drive.py X Y

It needs rclpy and NumPy. The path is planned on /map and followed by /tf; /scan holds the robot before an obstacle.
"""

import heapq
import math
import sys

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

RADIUS_M = 0.24
NEAR_M = 0.05
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def inflated(blocked: np.ndarray, cells: int) -> np.ndarray:
    """Returns the cells that are at most so many cells from a blocked one."""
    wide = blocked.copy()
    for dy in range(-cells, cells + 1):
        for dx in range(-cells, cells + 1):
            if dx * dx + dy * dy <= cells * cells:
                wide |= np.roll(blocked, (dy, dx), (0, 1))
    return wide


def path(blocked: np.ndarray, start: tuple[int, int], goal: tuple[int, int]) -> list[tuple[int, int]]:
    """Returns the cells (row, column) of the shortest path, by Dijkstra's algorithm; empty: there is none."""
    before, cost, queue = {start: start}, {start: 0.0}, [(0.0, start)]
    while queue:
        so_far, cell = heapq.heappop(queue)
        if cell == goal:
            steps = [cell]
            while steps[-1] != start:
                steps.append(before[steps[-1]])
            return steps[::-1]
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                other = cell[0] + dy, cell[1] + dx
                inside = 0 <= other[0] < blocked.shape[0] and 0 <= other[1] < blocked.shape[1]
                longer = so_far + math.hypot(dx, dy)
                if inside and not blocked[other] and longer < cost.get(other, math.inf):
                    cost[other], before[other] = longer, cell
                    heapq.heappush(queue, (longer, other))
    return []


class Driver(Node):
    """Follows a path to a place."""

    def __init__(self, goal_xy_m: tuple[float, float]) -> None:
        super().__init__("driver", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.goal_xy_m, self.frames, self.ahead_m, self.route, self.grid = goal_xy_m, {}, math.inf, None, None
        self.create_subscription(OccupancyGrid, "/map", self.on_map, LATCHED)
        self.create_subscription(TFMessage, "/tf", self.on_frames, 100)
        self.create_subscription(LaserScan, "/scan", self.on_scan, qos_profile_sensor_data)
        self.velocity = self.create_publisher(Twist, "/cmd_vel", 10)
        self.stop = self.create_client(Trigger, "/stubborn/stop")
        self.stopped = None
        self.create_timer(0.05, self.drive)  # simulated seconds, by /clock

    def on_map(self, grid: OccupancyGrid) -> None:
        """Keeps the map."""
        self.grid = grid

    def on_frames(self, message: TFMessage) -> None:
        """Keeps the frames, as x, y and yaw in their parents."""
        for frame in message.transforms:
            place, turn = frame.transform.translation, frame.transform.rotation
            self.frames[frame.child_frame_id] = place.x, place.y, 2.0 * math.atan2(turn.z, turn.w)

    def on_scan(self, scan: LaserScan) -> None:
        """Keeps the distance to what is in the robot's way."""
        ranges = np.asarray(scan.ranges)
        angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        seen = (np.cos(angles) > 0.0) & (np.abs(ranges * np.sin(angles)) < 0.2) & np.isfinite(ranges)
        self.ahead_m = float(np.min(ranges[seen], initial=math.inf))

    def pose(self) -> tuple[float, float, float] | None:
        """Returns x, y and yaw in the frame `map`."""
        if not {"odom", "base_link"} <= set(self.frames):
            return None
        (x0, y0, turn), (x, y, yaw) = self.frames["odom"], self.frames["base_link"]
        return (
            x0 + x * math.cos(turn) - y * math.sin(turn), y0 + x * math.sin(turn) + y * math.cos(turn), turn + yaw
        )  # fmt: skip

    def planned(self, x_m: float, y_m: float) -> list[tuple[float, float]]:
        """Returns the places of the path from a place to the goal."""
        info = self.grid.info
        cell_m, origin = info.resolution, info.origin.position
        values = np.asarray(self.grid.data, np.int8).reshape(info.height, info.width)
        blocked = inflated(values > 50, math.ceil(RADIUS_M / cell_m)) | (values < 0)

        def cell(x: float, y: float) -> tuple[int, int]:
            rows, cols = np.nonzero(~blocked)
            row, col = (y - origin.y) / cell_m - 0.5, (x - origin.x) / cell_m - 0.5
            nearest = int(np.argmin((rows - row) ** 2 + (cols - col) ** 2))
            return int(rows[nearest]), int(cols[nearest])

        found = path(blocked, cell(x_m, y_m), cell(*self.goal_xy_m))
        return [(origin.x + (col + 0.5) * cell_m, origin.y + (row + 0.5) * cell_m) for row, col in found]

    def drive(self) -> None:
        """Publishes the next velocity; at the end of the path, calls STOP."""
        command, pose = Twist(), self.pose()
        if pose is not None and self.grid is not None and self.stopped is None:
            x, y, yaw = pose
            if self.route is None:
                self.route = self.planned(x, y)
            while self.route and math.hypot(self.route[0][0] - x, self.route[0][1] - y) < 0.25:
                self.route.pop(0)
            if self.route:
                error = math.remainder(math.atan2(self.route[0][1] - y, self.route[0][0] - x) - yaw, math.tau)
                command.angular.z = max(-1.5, min(1.5, 2.0 * error))
                if abs(error) < 0.5 and self.ahead_m > RADIUS_M + NEAR_M:
                    command.linear.x = 0.4 * math.cos(error)
            elif self.stop.service_is_ready():
                self.stopped = self.stop.call_async(Trigger.Request())
        self.velocity.publish(command)


def main() -> None:
    """Drives to the place that the command line names."""
    rclpy.init()
    node = Driver((float(sys.argv[1]), float(sys.argv[2])))
    while node.stopped is None or not node.stopped.done():
        rclpy.spin_once(node, timeout_sec=0.1)
    print("stopped", node.stopped.result().success)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
