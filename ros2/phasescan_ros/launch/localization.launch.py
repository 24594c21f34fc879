"""phasescan in place of amcl, with nav2's map_server and lifecycle manager."""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    params = os.path.join(get_package_share_directory('phasescan_ros'), 'params', 'localization.yaml')
    sim_time = {'use_sim_time': LaunchConfiguration('use_sim_time')}
    return LaunchDescription([
        DeclareLaunchArgument('map', description='yaml of the map'),
        DeclareLaunchArgument('params_file', default_value=params),
        DeclareLaunchArgument('use_sim_time', default_value='false'),
        Node(package='nav2_map_server', executable='map_server', name='map_server', output='screen',
             parameters=[{'yaml_filename': LaunchConfiguration('map')}, sim_time]),
        Node(package='phasescan_ros', executable='localization_node', name='amcl', output='screen',
             parameters=[LaunchConfiguration('params_file'), sim_time]),
        Node(package='nav2_lifecycle_manager', executable='lifecycle_manager', name='lifecycle_manager_localization',
             output='screen', parameters=[{'autostart': True, 'node_names': ['map_server', 'amcl']}, sim_time])])
