#!/usr/bin/env bash
# URDF files imported: robots of several kinds, their numbers by hand, their accelerations as MuJoCo has them (where
# it is installed); and what is refused, in one line with its place.
# about: runner/import
. "$(dirname "$0")/scratch.sh"
robots=$tests/robots

# Accelerations agree, unless there is no libmujoco to say so.
agrees() { # name
    if grep -q 'not compared with the file: .*apt install' log; then
        skip "$1" "no libmujoco"
    else
        awk '/random states: accelerations agree/ { for (i = 1; i < NF; i++) if ($i == "to") good = $(i + 1) + 0 < 1e-9 }
            END { exit !good }' log
        result $? "$1"
    fi
}
imports() { # name
    expect "$1 is imported" 0 "$stance" import "$robots/$1.urdf" -o "$1.yaml" into "$1.log"
    agrees "$1 moves as its file's robot"
    expect "$1 is a scenario" 0 "$stance" check "$1.yaml"
}
# Says of an import, and of its file's head.
noted() { # name, pattern
    grep -qE -- "$2" "$1.log" && sed 's/^# *//' "$1.yaml" | tr '\n' ' ' | grep -qE -- "$2"
    result $? "$1: $2"
}

for name in turned_leg hanging exported spring_hopper box_feet sideways post; do imports "$name"; done
noted turned_leg 'rpy such as 1.57 .*: 3'
noted turned_leg 'dry friction in joint knee'
noted hanging 'point masses, as they have no <inertia>: bob'
noted exported 'joint hip: lower = upper = 0 .* no stops here'
noted exported 'knee is continuous, and its limits are kept'
noted exported 'left out.*: plugin'
noted spring_hopper 'leg has an effort and no <transmission>: no motor'
noted sideways 'x is the file.s \(0 1 0\)'
expect "its plane may be asked for" 0 "$stance" import "$robots/sideways.urdf" --plane yz -o asked.yaml
is "... and is the one that is found" 'diff <(grep -v "^#" asked.yaml) <(grep -v "^#" sideways.yaml)'
expect "another one is not that of its hinges" 2 "$stance" import "$robots/sideways.urdf" --plane xz -o no.yaml \
    says 'sideways.urdf:25: .*ankle'
expect "a base is fixed when it is asked for" 0 "$stance" import "$robots/turned_leg.urdf" --weld trunk --weld hip -o fixed.yaml
agrees "... and moves as the file's would"
is "... without being free" ! grep -q 'joint: free' fixed.yaml

# What it comes to by hand.
holds "numbers can be read" <<'END'
from scipy.spatial.transform import Rotation as R

def robot(name):
    return yaml.safe_load(open(name + ".yaml"))["robot"]

def near(what, got, wanted):
    print("ok" if np.allclose(got, wanted, rtol=1e-12, atol=1e-14) else "not ok", "- by hand:", what, got, wanted)

def merged(parts):
    """Mass, place (x, z) and moment about y through it, of bodies: mass, place, tensor."""
    mass = sum(m for m, _, _ in parts)
    centre = sum(m * p for m, p, _ in parts) / mass
    inertia = sum(I[1, 1] + m * np.sum((p - centre)[[0, 2]] ** 2) for m, p, I in parts)
    return mass, centre[[0, 2]], inertia

def turned(r, *i):
    xx, yy, zz, xy, xz, yz = i
    m = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return r.as_matrix() @ m @ r.as_matrix().T

rpy = lambda r, p, y: R.from_euler("xyz", [r, p, y])
leg = robot("turned_leg")["bodies"]
neck = rpy(0, -0.25, 0)
mass, centre, inertia = merged([
    (9, np.array([0.02, 0, 0.2]), turned(rpy(0, 0.3, 0), 0.3, 0.4, 0.2, 0, 0.02, 0)),
    (1.5, np.array([0.03, 0, 0.45]) + neck.apply([0.01, 0, 0.03]),
     turned(neck * rpy(np.pi / 2, 0, 0.2), 0.011, 0.007, 0.009, 0.001, 0, 0))])
trunk = leg["trunk"]
near("trunk and head", [trunk["mass"], *trunk["centre"], trunk["inertia"]], [mass, *centre, inertia])
near("+y: turned the other way", leg["thigh"]["angle"], -0.4)
near("... and so are its limits", leg["thigh"]["limits"], [-0.8, 1.2])
near("x down", [leg["shank"]["angle"], *leg["shank"]["centre"]], [-np.pi / 2, 0.15, 0.01])
near("about z, which is y", [leg["shank"]["inertia"], *leg["shank"]["limits"]], [0.031, -2, 0.1])
near("joint numbers", [leg["thigh"]["damping"], leg["shank"]["damping"]], [0.7, 0.2])
assert "camera" not in leg and "head" not in leg
hanging = robot("hanging")
near("n^2 J", hanging["bodies"]["rod"]["armature"], 30**2 * 2e-5)
near("hangs there", hanging["bodies"]["bob"]["at"], [0.1, 1.9])
near("effort is of the joint", hanging["actuators"]["elbow"]["limit"], 12)
exported = robot("exported")["bodies"]
near("-y: as here", exported["lower_leg"]["limits"], [-2.2, 0.1])
assert "limits" not in exported["upper_leg"]
hopper = robot("spring_hopper")["bodies"]
near("a gear of the other sign", hopper["sleeve"]["armature"], 12**2 * 1.5e-4)
shin = hopper["shin"]
near("a slide", [shin["stiffness"], shin["rest"], shin["damping"], *shin["limits"], *shin["axis"]],
     [900, 0.01, 4, -0.05, 0.2, 0, 1])
sole = list(robot("box_feet")["contacts"].values())[0]
near("a box's lower side", sorted([sole["from"], sole["to"]]), [[-0.08, -0.05], [0.16, -0.05]])
near("its friction", yaml.safe_load(open("box_feet.yaml"))["ground"]["friction"], 0.7)
pelvis = robot("sideways")["bodies"]["pelvis"]
near("about x", [pelvis["inertia"], *pelvis["centre"], pelvis["angle"], *pelvis["limits"]],
     [0.4, 0.12, 0.1, 0.1, -0.3, 0.6])
END
retold facts

# ---- what is refused: a file with one thing wrong ---------------------------------------------------
cat >good.urdf <<'END'
<robot name="good">
  <link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <link name="b">
    <inertial>
      <origin xyz="0 0 -0.1" rpy="0 0 0"/>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute">
    <parent link="a"/>
    <child link="b"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/>
  </joint>
</robot>
END
expect "a good one" 0 "$stance" import good.urdf -o good.yaml
changed() { # name, sed's command, pattern of a note: is imported, and says so
    sed -e "$2" good.urdf >changed.urdf
    expect "$1" 0 "$stance" import changed.urdf -o changed.yaml --force says "$3"
}
changed "lower above upper is no limit" '15s/-1" upper="1/1" upper="-1/' 'lower > upper is what Bullet.s files write without limits: it has no stops'
is "... nor has the scenario" ! grep -q "limits: \[" changed.yaml
changed "it begins at its stop, as it counts" '15s/-1" upper="1/-0.7" upper="-0.3/' 'b begins at its limit, 0.3, not at 0'
changed "blanks, and a version that there is none of" '1s/^/\n \n<?xml version="0.0" encoding="ISO-8859-1"?>\n/;2s/"a"/"\xe4"/;12s/"a"/"\xe4"/' 'root ä is free'
changed "a box that is tilted stands on its lower face" '8i <origin rpy="0 0.4 0"/>
9s/<sphere radius="0.1"/<box size="0.2 0.1 0.04"/;s/xyz="0 0 -0.1" rpy="0 0 0"/xyz="0 0 0"/;13,14s/<child/<origin rpy="0 0.4 0"\/>&/' 'lower side touches'
is "... its sole" grep -q 'from: \[-0.1, -0.02\], to: \[0.1, -0.02\]' changed.yaml
changed "a motor of a joint that is fixed is left out" '11s/revolute/fixed/;17i <transmission><joint name="j"/></transmission>' 'motors left out, as their joints are fixed or floating: j'
says "what was read is compared with" 'agree with those of what was read of the file\|not compared'
sed -e '/collision/d;7s/i\(..\)="1"/i\1="0"/g;5s/-0.1/0/;2s/.*/<link name="world"\/>/;12s/"a"/"world"/' good.urdf >turns.urdf
expect "what nothing resists is refused" 2 "$stance" import turns.urdf -o bad.yaml \
    says '^stance import: turns.urdf: as a scenario: robot.bodies.b: nothing resists its turning.* or hold it: --weld j$'
refused() { # name, line, pattern, sed's command
    sed -e "$4" good.urdf >bad.urdf
    expect "$1 is refused" 2 "$stance" import bad.urdf -o bad.yaml lines 1 \
        tells "^stance import: bad\.urdf:$2: .*$3" is [ ! -e bad.yaml ]
}
refused "text for a number" 6 '<mass value="heavy">: is not one number' '6s/"1"/"heavy"/'
refused "what is not finite" 7 '<inertia iyy="nan">: is not one number' '7s/iyy="1"/iyy="nan"/'
refused "a property of xacro" 6 'expand the file' '6s/"1"/"${mass}"/'
refused "commas between numbers" 5 'blanks, not commas' '5s/0 0 -0.1/0, 0, -0.1/'
refused "two numbers of three" 5 'is not three numbers' '5s/0 0 -0.1/0 -0.1/'
refused "four numbers of three" 14 'is not three numbers' '14s/0 1 0/0 1 0 0/'
refused "no mass" 4 'no <mass' '6d'
refused "less than no mass" 6 'less than nothing' '6s/"1"/"-1"/'
refused "a moment that is missing" 7 'no iyy="..."' '7s/iyy="1"//'
refused "a moment that is negative" 7 'izz="-1".*less than nothing' '7s/izz="1"/izz="-1"/'
refused "a link that is missing" 13 'joint j: there is no link called c' '13s/"b"/"c"/'
refused "a joint without a parent" 11 'joint j has no <parent' '12d'
refused "a type that is unknown" 11 'type "ball" is none of fixed, revolute' '11s/revolute/ball/'
refused "an axis without direction" 14 'no direction' '14s/0 1 0/0 0 0/'
refused "a size that is missing" 9 '<sphere> has no radius' '9s/radius="0.1"//'
refused "a size less than nothing" 9 'less than nothing' '9s/0.1/-0.1/'
refused "a shape that is missing" 9 'no <geometry>' '9s/<sphere[^>]*>//'
refused "two links of one name" 3 'two links called a, the other one at line 2' '3s/"b"/"a"/'
refused "two trees" 11 'two trees: neither a nor c' '11i <link name="c"/>'
refused "a loop" 17 'link b is the child of joint j, too' '17i <joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint>'
refused "two joints of one name" 17 'two joints called j, the other one at line 11' '17i <joint name="j" type="fixed"><parent link="b"/><child link="a"/></joint>'
refused "a circle" 2 'every link is the child of a joint' '17i <joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint>'
refused "a circle beside the tree" 17 'link c hangs on itself, by joint k' '17i <link name="c"/><joint name="k" type="fixed"><parent link="c"/><child link="c"/></joint>'
refused "a floating link in the tree" 11 'j is floating, but its parent a is not the world' '11s/revolute/floating/'
refused "a joint that follows another one" 16 'mimic joint j .* or --weld it' '16s/^/<mimic joint="j"\/>/'
expect "... unless it is held" 0 "$stance" import bad.urdf --weld j -o follower.yaml
refused "a transmission of no joint" 17 'transmission of joint k, which the robot does not have' '17i <transmission><joint name="k"/></transmission>'
refused "a transmission of two joints" 17 'of several joints' '17i <transmission><joint name="j"/><joint name="j"/></transmission>'
refused "a gear of nothing" 17 'reduction of 0' '17i <transmission><joint name="j"/><mechanicalReduction>0</mechanicalReduction></transmission>'
refused "a rotor of less than nothing" 17 'inertia of -4 at the joint' '17i <transmission><joint name="j"/><drake:gear_ratio value="2"/><drake:rotor_inertia value="-1"/></transmission>'
refused "a damper that drives" 16 '<dynamics damping="-1">: less than nothing' '16i <dynamics damping="-1"/>'
refused "xacro" 2 'expand the file first' '2i <xacro:property name="m" value="1"/>'
refused "entities" '[0-9]+' 'DOCTYPE' '1i <!DOCTYPE robot [<!ENTITY m "1">]>'
refused "what is not XML" 10 'not XML' '10s/link/lonk/'
refused "half a file" '[0-9]+' 'not XML' '8,$d'
refused "a link without gravity" 17 'without gravity.*b' '17i <gazebo reference="b"><turnGravityOff>true</turnGravityOff></gazebo>'
refused "a spring between links" 17 'linear_bushing_rpy' '17i <drake:linear_bushing_rpy/>'
printf '<sdf version="1.6"><model/></sdf>\n' >other.urdf
expect "SDF is refused" 2 "$stance" import other.urdf -o bad.yaml says 'SDF'
expect "a folder is refused" 3 "$stance" import . -o bad.yaml
: >empty.urdf
expect "an empty file is refused" 2 "$stance" import empty.urdf -o bad.yaml says 'empty.urdf'
ten='&n;&n;&n;&n;&n;&n;&n;&n;&n;&n;'
{
    echo '<?xml version="1.0"?><!DOCTYPE robot [<!ENTITY n0 "1">'
    for ((i = 1; i < 12; i++)); do echo "<!ENTITY n$i \"${ten//n/n$((i - 1))}\">"; done
    echo ']><robot name="&n11;"><link name="&n11;"/></robot>'
} >bomb.urdf
expect "entities that grow are refused" 2 "$stance" import bomb.urdf -o bad.yaml says 'bomb.urdf:'
