"""A gait whose targets fit its impact, and its multiplier from posture and slopes at the footfall alone.

Outputs that the impact leaves at zero make the robot a pendulum of one degree of freedom, whose angular momentum
about the foot that stands is multiplied by delta at a footfall: the gait's largest multiplier is delta squared
(Westervelt, Grizzle, Koditschek, IEEE Trans. Autom. Control 48 (2003) 42). The impulse has no moment about the
foot that lands, so delta is the ratio of the angular momenta about both feet just before.

The paper's biped, absolute angles: trunk, the leg that stands (behind the hip), the one that lands; positive ahead
of the hip. The phase is minus the angle of the leg that stands; targets are the trunk's angle and the legs' sum."""
import numpy as np

LENGTH, MASSES = 0.535, np.array([1.8, 5.4, 1.8, 1.8])  # trunk's end, hip, feet
OLD, NEW = 2, 3  # the foot that stood, the one that lands
TRUNK, HALF, SLOPES = -0.2229, 0.2889, np.array([0.4752, -1.4991])  # before impact; of both targets by the phase
INNER = np.array([[-0.4708, -0.0725, -0.3009], [-0.2267, 0.325, 0.2529]])  # coefficients 2 to 4 of 0 to 6
RATE = 1.38  # 1/s, of the phase just after the footfall, about


def turned(angle):
    """Where a rod of the robot ends that is turned by an angle, and how it moves at a rate of 1."""
    return LENGTH * np.array([[np.sin(angle), -np.cos(angle)], [np.cos(angle), np.sin(angle)]])


def footfall():
    """delta^2, the slopes of both targets just after, and the rates of the angles there, where the phase's is 1."""
    places, jacobian = np.zeros((4, 2)), np.zeros((4, 2, 5))  # from the hip; by x, z of the hip and the angles
    for point, angle, turn in (0, 2, TRUNK + np.pi), (OLD, 3, -HALF), (NEW, 4, HALF):
        places[point], jacobian[point, :, angle] = turned(turn)
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1
    mass = np.einsum("p,pai,paj->ij", MASSES, jacobian, jacobian)
    before = np.array([0, 0, SLOPES[0], -1, SLOPES[1] + 1])
    before[:2] = -jacobian[OLD] @ before

    def momentum(foot):
        arm, moving = places - places[foot], jacobian @ before
        return MASSES @ (arm[:, 0] * moving[:, 1] - arm[:, 1] * moving[:, 0])

    lands = jacobian[NEW]
    thrown = np.linalg.solve(mass, lands.T)
    after = before - thrown @ np.linalg.solve(lands @ thrown, lands @ before)
    after /= -after[4]
    return (momentum(NEW) / momentum(OLD))**2, np.array([after[2], after[3] + after[4]]), after[2:]


def gait():
    """delta^2, and what makes scenarios/gaits/walks.yaml that gait, as --set takes it."""
    delta2, slopes, rates = footfall()
    ends = np.array([TRUNK, 0])
    reach = 2 * HALF / 6  # of the phase, by degree
    along = np.column_stack([ends, ends + reach * slopes, INNER, ends - reach * SLOPES, ends]).tolist()
    trunk, rear, front = (RATE * rates).tolist()
    stiff = {"proportional": 400, "derivative": 40}
    return delta2, {
        "controller.torque_limit": 1000,
        "controller.sample_time": 0,
        "controller.phase": {"of": {"theta": -1, "q1": -1}, "from": -HALF, "to": HALF},
        "controller.outputs.y1": {"of": {"theta": 1}, "along": along[0], **stiff},
        "controller.outputs.y2": {"of": {"theta": 2, "q1": 1, "q2": 1}, "along": along[1], **stiff},
        "initial.state": {"theta": TRUNK, "q1": HALF - TRUNK, "q2": -HALF - TRUNK,
                          "vtheta": trunk, "vq1": front - trunk, "vq2": rear - trunk},
    }
