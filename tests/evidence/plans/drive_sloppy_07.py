# skill: drive
# expected: unsupported
# because: imports what a plan has not got
import rospy
rospy.init_node('drive')
forward()
