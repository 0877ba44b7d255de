/* mechanism_errors.h - wrong descriptions for test_mechanism_reader.c: what stands there instead of
 * what in one of its two texts, and what is said of it.
 */
{"mass: 20", "mas: 20",
 "5:26: robot.bodies.trunk: unknown key 'mas'; did you mean 'mass'? (known: joint, coordinate, "
 "parent, "
 "like, at, axis, angle, mass, inertia, centre, stiffness, damping, rest, armature, limits, turn)"},
    {"  points:", "  point:",
     "14:3: robot: unknown key 'point'; did you mean 'points'? (known: bodies, contacts, points, "
     "actuators)"},
    {"at: [0, 0.625]", "where: [0, 0.625]",
     "15:25: robot.points.head: unknown key 'where' (known: body, at, lowest, force, impulse, "
     "from, to, frequency)"},
    {"{body: thigh1, limit: 150}", "{body: thigh1, torque: 150}",
     "17:26: robot.actuators.hip1: unknown key 'torque' (known: body, limit)"},
    {"foot1: {body: shank1, at: [0, -0.4]}", "foot1: {body: shank1, at: [0, -0.4], on: trunk}",
     "12:42: robot.contacts.foot1: unknown key 'on' (known: body, at, from, to, radius, "
     "friction_factor)"},
    {"foot1: {body: shank1, at: [0, -0.4]}",
     "foot1: {body: shank1, at: [0, -0.4], friction_factor: 0}",
     "12:59: robot.contacts.foot1.friction_factor: 0 is out of range (0.01 ... 100)"},
    {"    trunk: {joint: free, mass: 20, inertia: 2.22, centre: [0, 0.2]}", "    trunk: heavy",
     "5:12: robot.bodies.trunk: expected a mapping, found 'heavy'"},
    {"    head: {body: trunk, at: [0, 0.625]}", "    - head",
     "15:5: robot.points: expected a mapping of names, without dashes, found a list"},
    {"joint: free", "joint: fre",
     "5:20: robot.bodies.trunk.joint: unknown word 'fre'; did you mean 'free'? (known: free, "
     "hinge, slide, fixed)"},
    {"joint: free, ", "", "5:5: robot.bodies.trunk.joint is missing (free, hinge, slide, fixed)"},
    {"joint: free", "joint: [free]",
     "5:20: robot.bodies.trunk.joint: expected one of free, hinge, slide, fixed, found a list"},
    {"joint: free", "joint: fixed",
     "5:20: robot.bodies.trunk.joint: a root is free, or a hinge, or slides"},
    {"{joint: hinge, parent: thigh1", "{joint: free, parent: thigh1",
     "6:21: robot.bodies.shank1.joint: only the root is free; what has a parent is a hinge, "
     "slides, or is fixed"},
    {"{joint: hinge, parent: thigh1", "{joint: slide, axis: [0, 0], parent: thigh1",
     "6:28: robot.bodies.shank1.axis: [0, 0] has no direction"},
    {"{joint: hinge, parent: thigh1", "{joint: slide, turn: 1, parent: thigh1",
     "6:34: robot.bodies.shank1.turn: what slides has no such number"},
    {"{joint: hinge, parent: thigh1", "{joint: slide, axis: 1, parent: thigh1",
     "6:34: robot.bodies.shank1.axis: expected 2 numbers, found '1'"},
    {"    rotor: {joint: fixed", "    rotor: {joint: slide, limits: [0.2, 0.1]",
     "10:27: robot.bodies.rotor.limits: 0.2 is not below 0.1"},
    {"rotor: {joint: fixed, parent: trunk, mass: 0.5", "rotor: {joint: slide, parent: trunk",
     "10:5: robot.bodies.rotor: nothing with mass resists its sliding: give it, or what hangs from "
     "it, mass"},
    {"parent: thigh1", "parent: tigh1",
     "6:36: robot.bodies.shank1.parent: unknown body 'tigh1'; did you mean 'thigh1'? (known: "
     "trunk, shank1, thigh1, thigh2, shank2, rotor)"},
    {"parent: thigh1", "parent: [thigh1]",
     "6:36: robot.bodies.shank1.parent: expected the name of a body, found a list"},
    {"joint: hinge, parent: thigh1", "joint: hinge",
     "6:5: robot.bodies: 2 bodies hang from nothing (trunk, shank1): give all but one a parent"},
    {"thigh1: {joint: hinge, parent: trunk", "thigh1: {joint: hinge, parent: shank1",
     "6:5: robot.bodies: shank1, thigh1 hang from each other and not from a root: a tree has no "
     "loops"},
    {"parent: thigh2, like", "parent: shank2, like",
     "9:5: robot.bodies: shank2 hangs from itself and not from a root: a tree has no loops"},
    {"trunk: {joint: free", "trunk: {joint: hinge, parent: rotor",
     "5:5: robot.bodies: trunk, shank1, thigh1, thigh2, shank2, rotor hang from each other and not "
     "from a root: a tree has no loops"},
    {"like: thigh1", "like: leg",
     "8:49: robot.bodies.thigh2.like: unknown body 'leg' (known: trunk, shank1, thigh1, thigh2, "
     "shank2, rotor)"},
    {"thigh1: {joint: hinge, parent: trunk,", "thigh1: {joint: hinge, parent: trunk, like: thigh2,",
     "7:49: robot.bodies.thigh1.like: it would be like itself"},
    {"like: thigh1", "like: thigh2", "8:49: robot.bodies.thigh2.like: it would be like itself"},
    {"mass: 20", "mass: -20",
     "5:32: robot.bodies.trunk.mass: -20 is out of range (0 ... 1e+09 kg)"},
    {"mass: 20", "mass: 20 kg",
     "5:32: robot.bodies.trunk.mass: expected a number, found '20 kg' (numbers only; mass is in "
     "kg); write 20"},
    {"mass: 20", "mass: heavy", "5:32: robot.bodies.trunk.mass: expected a number, found 'heavy'"},
    {"mass: 20", "mass: .nan",
     "5:32: robot.bodies.trunk.mass: expected a number, found '.nan'; it must be finite"},
    {"mass: 20", "mass: .inf",
     "5:32: robot.bodies.trunk.mass: expected a number, found '.inf'; it must be finite"},
    {"mass: 20", "mass: 1e400", "5:32: robot.bodies.trunk.mass: '1e400' is too large for a number"},
    {"mass: 20", "mass: \"20\"",
     "5:32: robot.bodies.trunk.mass: expected a number, found the text \"20\"; remove the quotes"},
    {"mass: 20", "mass: [20]", "5:32: robot.bodies.trunk.mass: expected a number, found a list"},
    {"inertia: 2.22", "inertia: -1",
     "5:45: robot.bodies.trunk.inertia: -1 is out of range (0 ... 1e+09 kg m^2)"},
    {"mass: 20, inertia", "mass: 0, inertia",
     "5:35: robot.bodies.trunk.inertia: 2.22 kg m^2, but no mass"},
    {"mass: 20, inertia", "inertia", "5:26: robot.bodies.trunk.inertia: 2.22 kg m^2, but no mass"},
    {"centre: [0, 0.2]", "centre: 0.2",
     "5:59: robot.bodies.trunk.centre: expected 2 numbers, found '0.2'"},
    {"centre: [0, 0.2]", "centre: [0.2]",
     "5:59: robot.bodies.trunk.centre: expected 2 numbers, found 1"},
    {"centre: [0, 0.2]", "centre: [0, 0.2, 0]",
     "5:59: robot.bodies.trunk.centre: expected 2 numbers, found 3"},
    {"centre: [0, 0.2]", "centre: [0, up]",
     "5:63: robot.bodies.trunk.centre[1]: expected a number, found 'up'"},
    {"centre: [0, 0.2]", "centre: [0, 1e7]",
     "5:63: robot.bodies.trunk.centre[1]: 1e7 is out of range (-1000000 ... 1000000 m)"},
    {"limits: [-2.5, 0]", "limits: [0, -2.5]",
     "6:106: robot.bodies.shank1.limits: 0 is not below -2.5"},
    {"limits: [-2.5, 0]", "limits: [0, 0]", "6:106: robot.bodies.shank1.limits: 0 is not below 0"},
    {"limits: [-2.5, 0]", "limits: [-2.5, none, 0]",
     "6:114: robot.bodies.shank1.limits: expected 2 numbers, found 3"},
    {"limits: [-2.5, 0]", "stiffness: -1",
     "6:117: robot.bodies.shank1.stiffness: -1 is out of range (0 ... 1e+09 N m/rad)"},
    {"limits: [-2.5, 0]", "damping: -1",
     "6:115: robot.bodies.shank1.damping: -1 is out of range (0 ... 1e+09 N m s/rad)"},
    {"limits: [-2.5, 0]", "armature: -1",
     "6:116: robot.bodies.shank1.armature: -1 is out of range (0 ... 1e+09 kg m^2)"},
    {"limits: [-2.5, 0]", "axis: [0, 1]", "6:112: robot.bodies.shank1.axis: a hinge has no axis"},
    {"centre: [0, 0.2]", "stiffness: 10",
     "5:62: robot.bodies.trunk.stiffness: a free root has no joint"},
    {"centre: [0, 0.2]", "at: [0, 1]", "5:55: robot.bodies.trunk.at: a free root has no joint"},
    {"mass: 0.5, at", "damping: 1, at",
     "10:51: robot.bodies.rotor.damping: what is fixed has no joint"},
    {"limit: 150", "limit: 0",
     "17:33: robot.actuators.hip1.limit: 0 is out of range (more than 0, at most 1e+09 N m)"},
    {"limit: 150", "limit: -150",
     "17:33: robot.actuators.hip1.limit: -150 is out of range (more than 0, at most 1e+09 N m)"},
    {"axis: [1, 0]", "axis: [0, 0]", "5:26: robot.bodies.cart.axis: [0, 0] has no direction"},
    {"axis: [1, 0]", "centre: [0, 0], axis: [1, x]",
     "5:52: robot.bodies.cart.axis[1]: expected a number, found 'x'"},
    {"mass: 20", "mass: {kg: 20}",
     "5:32: robot.bodies.trunk.mass: expected a number, found a mapping"},
    {"like: thigh1", "like: [thigh1]",
     "8:49: robot.bodies.thigh2.like: expected the name of a body, found a list"},
    {"joint: free", "joint: {a: {b: {c: {d: 1}}}}",
     "5:20: robot.bodies.trunk.joint: expected one of free, hinge, slide, fixed, found a mapping"},
    {"mass: 0.1, centre: [0, 0.5]", "mass: 0.1",
     "6:5: robot.bodies.pole: nothing resists its turning: give it inertia, or mass off its joint"},
    {"mass: 0.1, centre: [0, 0.5]", "mass: 0",
     "6:5: robot.bodies.pole: nothing resists its turning: give it inertia, or mass off its joint"},
    {"cart: {joint: slide, axis: [1, 0], mass: 1, limits: [-2, 2]}",
     "cart: {joint: slide}\n    hub: {joint: hinge, parent: cart}",
     "6:5: robot.bodies.hub: nothing resists its turning: give it inertia, or mass off its joint"},
    {"cart: {joint: slide, axis: [1, 0], mass: 1, limits: [-2, 2]}",
     "cart: {joint: slide, mass: 1}\n    hub: {joint: hinge, parent: cart}\n    leg: {joint: "
     "hinge, "
     "parent: hub, mass: 1, centre: [0, -1]}",
     "6:5: robot.bodies.hub: nothing resists its turning: give it inertia, or mass off its joint"},
    {"initial: {state: {pole: 0.1}}",
     "initial: {equilibrium: {pole: 0}}\ncontroller: {kind: state-feedback, design: lqr, model: "
     "{bodies: {pole: {mass: 0}}}}",
     "10:66: controller.model.bodies.pole: nothing resists its turning: give it inertia, or mass "
     "off its joint"},
    {"head: {body: trunk, at: [0, 0.625]}",
     "head: {body: trunk, at: [0, 0.625], force: [1, 0], from: 2, to: 1}",
     "15:65: robot.points.head.to: 1 s is before from, 2 s"},
    {"body: shank1, at", "body: shin1, at",
     "12:19: robot.contacts.foot1.body: unknown body 'shin1'; did you mean 'shank1'? (known: "
     "trunk, shank1, thigh1, thigh2, shank2, rotor)"},
    {"body: shank1, at", "at",
     "12:5: robot.contacts.foot1.body is missing: the body that it belongs to"},
    {"at: [0, -0.4]}\n    foot2", "radius: 0.1}\n    foot2",
     "12:5: robot.contacts.foot1.at is missing (from and to make it a sole)"},
    {"from: [-0.05, -0.4], ", "",
     "13:5: robot.contacts.foot2.from is missing: a sole has two ends"},
    {", to: [0.1, -0.4]", "", "13:5: robot.contacts.foot2.to is missing: a sole has two ends"},
    {"from: [-0.05, -0.4]", "at: [0, 0], from: [-0.05, -0.4]",
     "13:31: robot.contacts.foot2.at: a sole, or a capsule, has from and to"},
    {"to: [0.1, -0.4]", "to: [-0.05, -0.4]",
     "13:48: robot.contacts.foot2.to: stands where from does: a sole has a length"},
    {"body: shank1, at: [0, -0.4]}", "body: shank1, at: [0, -0.4], radius: -0.1}",
     "12:50: robot.contacts.foot1.radius: -0.1 is out of range (0 ... 1000000 m)"},
    {"  actuators:\n    push",
     "  contacts: {wheel: {body: cart, at: [0, 0]}}\n  actuators:\n    push",
     "7:28: robot.contacts.wheel.body: cart cannot move off its rail"},
    {"{body: thigh1, limit", "{body: thigh, limit",
     "17:18: robot.actuators.hip1.body: unknown body 'thigh'; did you mean 'thigh1'? (known: "
     "trunk, shank1, thigh1, thigh2, shank2, rotor)"},
    {"{body: thigh1, limit", "{body: trunk, limit",
     "17:18: robot.actuators.hip1.body: trunk has no joint to drive: it is free"},
    {"{body: thigh1, limit", "{body: rotor, limit",
     "17:18: robot.actuators.hip1.body: rotor has no joint to drive: it is fixed"},
    {"{body: shank1}", "{body: thigh1}",
     "18:19: robot.actuators.knee1.body: hip1 drives this joint already"},
    {"{body: shank1}", "{}",
     "18:5: robot.actuators.knee1.body is missing: the body that it drives"},
    {"    rotor:", "    trunk:", "10:5: duplicate key 'trunk' (first in line 5)"},
    {"    rotor:", "    x:",
     "10:5: robot.bodies: 'x' is no name: a coordinate of a free root, or its rate, is called so"},
    {"    rotor:", "    on:",
     "10:5: robot.bodies: 'on' is no name: some readers of YAML take it for true, false or "
     "nothing"},
    {"    rotor:", "    True:",
     "10:5: robot.bodies: 'True' is no name: some readers of YAML take it for true, false or "
     "nothing"},
    {"    rotor:", "    2nd:",
     "10:5: robot.bodies: '2nd' is no name: a name is a letter, then letters, digits or _"},
    {"    rotor:", "    my-hub:",
     "10:5: robot.bodies: 'my-hub' is no name: a name is a letter, then letters, digits or _"},
    {"    rotor:", "    \"\":",
     "10:5: robot.bodies: '' is no name: a name is a letter, then letters, digits or _"},
    {"    rotor:", "    \"a b\":",
     "10:5: robot.bodies: 'a b' is no name: a name is a letter, then letters, digits or _"},
    {"    rotor:", "    tête:",
     "10:5: robot.bodies: 'tête' is no name: a name is a letter, then letters, digits or _"},
    {"    rotor:", "    scale:",
     "10:5: robot.bodies: 'scale' is no name: a key of initial.offset or initial.equilibrium is "
     "called so"},
    {"    rotor:", "    vtrunk:",
     "10:5: robot.bodies.vtrunk: the rate of the body in line 5 is called so, too: choose another "
     "name"},
    {"    rotor:", "    a_body_with_a_name_of_64_letters_xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx:",
     "10:5: robot.bodies: 'a_body_with_a_name_of_64_letters_xxxxxxxxxxx...' is no name: a "
     "name has at most 63 letters"},
    {"    foot1:", "    trunk:",
     "12:5: robot.contacts.trunk: the part in line 5 is called so, too: choose another name"},
    {"    foot1:", "    foot2_toe:",
     "4:3: robot: foot2_toe would stand for two contacts (an end of a sole, or the stop of a "
     "joint, is called so): choose other names"},
    {"    head:", "    foot1:",
     "15:5: robot.points.foot1: the part in line 12 is called so, too: choose another name"},
    {"    hip1:", "    knee1:", "18:5: duplicate key 'knee1' (first in line 17)"},
    {"    rotor: {joint: fixed",
     "    a0: {joint: hinge, parent: trunk, mass: 1, centre: [0, 1]}\n    a1: {joint: hinge, p"
     "arent: trunk, mass: 1, centre: [0, 1]}\n    a2: {joint: hinge, parent: trunk, mass: 1, c"
     "entre: [0, 1]}\n    a3: {joint: hinge, parent: trunk, mass: 1, centre: [0, 1]}\n    a4: "
     "{joint: hinge, parent: trunk, mass: 1, centre: [0, 1]}\n    a5: {joint: hinge, parent: t"
     "runk, mass: 1, centre: [0, 1]}\n    a6: {joint: hinge, parent: trunk, mass: 1, centre: ["
     "0, 1]}\n    rotor: {joint: fixed",
     "5:5: robot.bodies: 12 of them turn or slide against their parents; at most 11"},
    {"    rotor: {joint: fixed",
     "    a0: {joint: slide, parent: trunk, mass: 1}\n    a1: {joint: slide, parent: a0, mass:"
     " 1}\n    a2: {joint: slide, parent: a1, mass: 1}\n    a3: {joint: slide, parent: a2, mas"
     "s: 1}\n    a4: {joint: slide, parent: a3, mass: 1}\n    a5: {joint: slide, parent: a4, m"
     "ass: 1}\n    a6: {joint: slide, parent: a5, mass: 1}\n    rotor: {joint: fixed",
     "5:5: robot.bodies: 12 of them turn or slide against their parents; at most 11"},
    {"    rotor: {joint: fixed",
     "    b0: {joint: fixed, parent: trunk}\n    b1: {joint: fixed, parent: trunk}\n    b2: {j"
     "oint: fixed, parent: trunk}\n    b3: {joint: fixed, parent: trunk}\n    b4: {joint: fixe"
     "d, parent: trunk}\n    b5: {joint: fixed, parent: trunk}\n    b6: {joint: fixed, parent:"
     " trunk}\n    b7: {joint: fixed, parent: trunk}\n    b8: {joint: fixed, parent: trunk}\n "
     "   b9: {joint: fixed, parent: trunk}\n    b10: {joint: fixed, parent: trunk}\n    b11: {"
     "joint: fixed, parent: trunk}\n    b12: {joint: fixed, parent: trunk}\n    b13: {joint: f"
     "ixed, parent: trunk}\n    b14: {joint: fixed, parent: trunk}\n    b15: {joint: fixed, pa"
     "rent: trunk}\n    b16: {joint: fixed, parent: trunk}\n    b17: {joint: fixed, parent: tr"
     "unk}\n    b18: {joint: fixed, parent: trunk}\n    b19: {joint: fixed, parent: trunk}\n  "
     "  b20: {joint: fixed, parent: trunk}\n    b21: {joint: fixed, parent: trunk}\n    b22: {"
     "joint: fixed, parent: trunk}\n    b23: {joint: fixed, parent: trunk}\n    b24: {joint: f"
     "ixed, parent: trunk}\n    b25: {joint: fixed, parent: trunk}\n    rotor: {joint: fixed",
     "5:5: robot.bodies: 32 of them; at most 31"},
    {"    head:",
     "    p0: {body: trunk}\n    p1: {body: trunk}\n    p2: {body: trunk}\n    p3: {body: trunk}\n "
     "   p4: {body: trunk}\n    p5: {body: trunk}\n    p6: {body: trunk}\n    p7: {body: trunk}\n  "
     "  head:",
     "15:5: robot.points: 9 of them; at most 8"},
    {"    foot1:",
     "    c0: {body: trunk, at: [0, 0]}\n    c1: {body: trunk, at: [0, 0]}\n    c2: {body: tru"
     "nk, at: [0, 0]}\n    c3: {body: trunk, at: [0, 0]}\n    c4: {body: trunk, at: [0, 0]}\n "
     "   c5: {body: trunk, at: [0, 0]}\n    c6: {body: trunk, at: [0, 0]}\n    c7: {body: trun"
     "k, at: [0, 0]}\n    c8: {body: trunk, at: [0, 0]}\n    c9: {body: trunk, at: [0, 0]}\n  "
     "  c10: {body: trunk, at: [0, 0]}\n    c11: {body: trunk, at: [0, 0]}\n    c12: {body: tr"
     "unk, at: [0, 0]}\n    c13: {body: trunk, at: [0, 0]}\n    c14: {body: trunk, at: [0, 0]}"
     "\n    c15: {body: trunk, at: [0, 0]}\n    c16: {body: trunk, at: [0, 0]}\n    c17: {body"
     ": trunk, at: [0, 0]}\n    c18: {body: trunk, at: [0, 0]}\n    c19: {body: trunk, at: [0,"
     " 0]}\n    c20: {body: trunk, at: [0, 0]}\n    c21: {body: trunk, at: [0, 0]}\n    c22: {"
     "body: trunk, at: [0, 0]}\n    foot1:",
     "12:5: robot.contacts: 25 of them; at most 24"},
    {"    foot1:",
     "    c0: {body: trunk, from: [0, 0], to: [1, 0]}\n    c1: {body: trunk, from: [0, 0], to:"
     " [1, 0]}\n    c2: {body: trunk, from: [0, 0], to: [1, 0]}\n    c3: {body: trunk, from: ["
     "0, 0], to: [1, 0]}\n    c4: {body: trunk, from: [0, 0], to: [1, 0]}\n    c5: {body: trun"
     "k, from: [0, 0], to: [1, 0]}\n    c6: {body: trunk, from: [0, 0], to: [1, 0]}\n    c7: {"
     "body: trunk, from: [0, 0], to: [1, 0]}\n    c8: {body: trunk, from: [0, 0], to: [1, 0]}"
     "\n    c9: {body: trunk, from: [0, 0], to: [1, 0]}\n    c10: {body: trunk, from: [0, 0], "
     "to: [1, 0]}\n    c11: {body: trunk, from: [0, 0], to: [1, 0]}\n    foot1:",
     "4:3: robot: 31 contacts, counting both ends of soles and stops: at most 30 fit"},
    {"robot:\n  bodies:\n    cart: {joint: slide, axis: [1, 0], mass: 1, limits: [-2, 2]}\n    "
     "pole: {joint: hinge, parent: cart, mass: 0.1, centre: [0, 0.5]}\n  actuators:\n    push: "
     "{body: cart, limit: 20}\n",
     "", "1:1: robot is missing: it describes the mechanism"},
    {"  bodies:\n    cart: {joint: slide, axis: [1, 0], mass: 1, limits: [-2, 2]}\n    pole: "
     "{joint: hinge, parent: cart, mass: 0.1, centre: [0, 0.5]}\n",
     "", "4:3: robot.bodies is missing: a mechanism is made of them"},
    {"  bodies:\n    cart: {joint: slide, axis: [1, 0], mass: 1, limits: [-2, 2]}\n    pole: "
     "{joint: hinge, parent: cart, mass: 0.1, centre: [0, 0.5]}\n",
     "  bodies: {}\n", "4:11: robot.bodies: there is no body"},
    {"contacts: [foot2]}", "contacts: [heel]}",
     "19:63: ground.contacts: unknown word 'heel' (known: foot1, foot2)"},
    {"contacts: [foot2]}", "contacts: [foot1]}",
     "19:52: ground.contacts: foot2, which is to carry the robot, is not among them"},
    {"slope: 0.1", "slope: 2", "19:32: ground.slope: 2 is out of range (-1.5708 ... 1.5708 rad)"},
    {"gravity: 1.62", "gravity: -9.81",
     "19:46: ground.gravity: -9.81 is out of range (0 ... 10000 m/s^2)"},
    {"support: [foot2]", "support: foot2",
     "20:81: initial.support: expected a list of names, found 'foot2'; write [foot2]"},
    {"support: [foot2]", "support: [foot3]",
     "20:82: initial.support: unknown word 'foot3'; did you mean 'foot1'? (known: foot1, foot2)"},
    {"state: {trunk", "state: {z: 1, trunk",
     "20:19: initial.state.z: with initial.support it follows from what the robot stands on"},
    {"state: {trunk", "state: {trnk",
     "20:19: initial.state: unknown key 'trnk'; did you mean 'trunk'? (known: x, z, trunk, thigh1, "
     "shank1, thigh2, shank2, vx, vz, vtrunk, vthigh1, vshank1, vthigh2, vshank2)"},
    {"state: {pole: 0.1}", "state: {pole: 0.1}, support: [cart]",
     "9:31: initial: the scene mechanism has no key 'support' (known: equilibrium, offset, state)"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {grid: [{path: robot.bodies.trunk.mas, values: [1]}]}\n",
     "22:23: sweep.grid[0]: unknown field 'robot.bodies.trunk.mas'; did you mean "
     "'robot.bodies.trunk.mass'? (stance describe lists them)"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {grid: [{path: robot.bodies.trunk.joint, values: [free]}]}\n",
     "22:23: sweep.grid[0]: robot.bodies.trunk.joint cannot be swept"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {grid: [{path: robot.bodies.trunk.mass, from: 0, to: 1, count: "
     "2}]}\n",
     "22:23: sweep.grid[0]: with robot.bodies.trunk.mass = 0 robot.bodies.trunk.inertia: 2.22 kg "
     "m^2, but no mass"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {grid: [{path: \"robot.bodies.shank1.limits[1]\", values: [0, "
     "-3]}]}\n",
     "22:23: sweep.grid[0]: with robot.bodies.shank1.limits[1] = -3 robot.bodies.shank1.limits: "
     "-2.5 is not below -3"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {grid: [{path: \"robot.bodies.shank1.limits[2]\", values: [0]}]}\n",
     "22:23: sweep.grid[0]: robot.bodies.shank1.limits[2] has 2 items, so [2] is beyond the end"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\nsweep: {sample: {method: random, count: 3, vary: [{path: "
     "robot.bodies.trunk.mass, from: -1, to: 1}]}}\n",
     "22:89: robot.bodies.trunk.mass: -1 is out of range (0 ... 1e+09 kg)"},
    {"initial: {state: {pole: 0.1}}",
     "controller: {kind: decoupling, controlled: x-z}\ninitial: {state: {pole: 0.1}}",
     "9:44: controller.controlled: unknown word 'x-z' (known: cart, pole)"},
    {"stop: {time: 5}\n",
     "stop: {time: 5}\ncontroller: {kind: hold, kp: 1, kd: 1, target: {rotor: 1}}\n",
     "22:49: controller.target: unknown key 'rotor' (known: thigh1, shank1)"},
