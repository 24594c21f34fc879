"""The SLAM node as launch files start it: it becomes active, and a scan brings a map and map -> odom -> base."""
import math
import unittest

import launch
import launch_ros.actions
import launch_testing.actions
import pytest
import rclpy
from lifecycle_msgs.srv import ChangeState
from nav_msgs.msg import OccupancyGrid
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage


@pytest.mark.launch_test
def generate_test_description():
    node = launch_ros.actions.LifecycleNode(package='phasescan_ros', executable='slam_node', name='slam_toolbox', namespace='',
                                            parameters=[{'mounting_from_tf': False, 'odometry': 'none'}])
    return launch.LaunchDescription([node, launch_testing.actions.ReadyToTest()])


class SlamNode(unittest.TestCase):

    def test_scans_bring_a_map(self):
        rclpy.init()
        node = rclpy.create_node('tester')
        client = node.create_client(ChangeState, 'slam_toolbox/change_state')
        self.assertTrue(client.wait_for_service(timeout_sec=20))
        for transition in (1, 3):
            request = ChangeState.Request()
            request.transition.id = transition
            future = client.call_async(request)
            rclpy.spin_until_future_complete(node, future, timeout_sec=20)
            self.assertTrue(future.result().success)
        maps, transforms = [], []
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(OccupancyGrid, 'map', maps.append, latched)
        node.create_subscription(TFMessage, '/tf', lambda m: transforms.extend(m.transforms), 100)
        scans = node.create_publisher(LaserScan, 'scan', qos_profile_sensor_data)
        for _ in range(50):
            scans.publish(self.scan(node))
            rclpy.spin_once(node, timeout_sec=0.1)
        self.assertTrue(maps)
        pairs = {(t.header.frame_id, t.child_frame_id) for t in transforms}
        self.assertIn(('map', 'odom'), pairs)
        self.assertIn(('odom', 'base_footprint'), pairs)
        node.destroy_node()
        rclpy.shutdown()

    def scan(self, node):
        """A room of 4 m x 6 m seen from its middle."""
        scan = LaserScan()
        scan.header.stamp = node.get_clock().now().to_msg()
        scan.header.frame_id = 'laser'
        scan.angle_min, scan.angle_increment, scan.range_max = -math.pi, 2 * math.pi / 360, 10.0
        scan.angle_max = scan.angle_min + 359 * scan.angle_increment
        for i in range(360):
            angle = scan.angle_min + i * scan.angle_increment
            c, s = abs(math.cos(angle)) + 1e-9, abs(math.sin(angle)) + 1e-9
            scan.ranges.append(min(3.0 / c, 2.0 / s))
        return scan
