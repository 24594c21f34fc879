"""phasescan in place of slam_toolbox: configured and activated by itself (autostart)."""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, RegisterEventHandler
from launch.conditions import IfCondition
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition


def generate_launch_description():
    params = os.path.join(get_package_share_directory('phasescan_ros'), 'params', 'slam.yaml')
    autostart = LaunchConfiguration('autostart')
    node = LifecycleNode(
        package='phasescan_ros', executable='slam_node', name='slam_toolbox', namespace='', output='screen',
        parameters=[LaunchConfiguration('slam_params_file'), {'use_sim_time': LaunchConfiguration('use_sim_time')}])
    configure = EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=Transition.TRANSITION_CONFIGURE),
                          condition=IfCondition(autostart))
    activate = RegisterEventHandler(
        OnStateTransition(target_lifecycle_node=node, start_state='configuring', goal_state='inactive',
                          entities=[EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node),
                                                                transition_id=Transition.TRANSITION_ACTIVATE))]),
        condition=IfCondition(autostart))
    return LaunchDescription([
        DeclareLaunchArgument('slam_params_file', default_value=params),
        DeclareLaunchArgument('use_sim_time', default_value='false'),
        DeclareLaunchArgument('autostart', default_value='true', description='configure and activate at once'),
        node, configure, activate])
