# skill: fly-in-square-shape-traj
# expected: unsupported
# because: numpy is not there
import numpy as np
vel_traj = np.zeros((10, 3)).tolist()
