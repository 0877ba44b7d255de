#!/usr/bin/env bash
# Robots of MuJoCo's files become scenarios: each is taken by `check`, moves as MuJoCo has it, and says what is otherwise;
# what has no counterpart is refused in one line with its name.
# about: runner/import
. "$(dirname "$0")/scratch.sh"
robots=$tests/robots/mjcf
cat >probe.xml <<'END'
<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>
END
if ! "$stance" import probe.xml >log 2>&1; then
    if grep -q 'libmujoco' log; then
        is "without libmujoco one line says how to get it" [ "$(wc -l <log)" = 1 ]
        skip "robots in MJCF" "libmujoco is not installed"
        echo "## skipped: libmujoco is not installed, no file of MuJoCo's was imported"
    else
        result 1 "a ball is imported"
    fi
    exit "$failed"
fi

# ---- robots ------------------------------------------------------------------------------------------------------
imported() { # NAME OPTION...: and is checked; by MuJoCo accelerations are its own to 1e-9
    local file=$robots/$1.xml
    [ -e "$file" ] || file=$1.xml
    "$stance" import "$file" -o "$1.yaml" "${@:2}" >log 2>&1 </dev/null &&
        grep -qE 'random states: accelerations agree' log && "$stance" check "$1.yaml" >>log 2>&1
    result $? "$1 is imported, and moves as in MuJoCo"
}
has() { # NAME WHAT LINE...: the scenario, its lines joined, has each of these texts
    local name=$1 what=$2 bad=0 text
    shift 2
    tr -s '\n ' '  ' <"$name.yaml" | sed 's/# //g' >log
    for text in "$@"; do grep -qF -- "$text" log || { echo "not there: $text" >>log; bad=1; }; done
    result $bad "$name: $what"
}
imported classes
has classes "classes, an include, degrees" 'damping: 0.5, armature: 0.02, limits: [-1.5707963267948966, 1.0471975511965976]' \
    'hip: {body: thigh, limit: 150}' 'knee: {body: shank, limit: 80}'
# A capsule of 0.5 m, radius 0.04 and 900 kg/m^3: 900 pi r^2 (0.5 + 4/3 r).
has classes "mass from a shape" 'shank: {joint: hinge, parent: thigh, at: [0, -0.45], mass: 2.50322102638'
has classes "capsules, the larger friction of both" 'shank_shape: {body: shank, from: [0, -0.5], to: [0, 0], radius: 0.04,' \
    'friction_factor: 1.16666666' 'ground: {friction: 0.6}'
has classes "the posture of the file" 'initial: state: {z: 1.2}' 'method: {step: 0.002}'
imported turned
has turned "hinges about +y" 'trunk: {joint: free, angle: -0.1,' 'angle: 0.55,' 'rest: -0.4' 'limits: [-0.5, 1]'
has turned "what is otherwise is told" 'actuator shoe gives -300 to 600 in the file, -300 to 300 here' \
    'effect in the plane: trunk' 'motors are called as their joints are'
imported lying
has lying "two hinges of one body, across a plane of y and z" 'x is the file'"'"'s (0 1 0), z its (0 0 1)' \
    'shoulder: {joint: hinge, at: [0.1, 2]}' 'arm: {joint: hinge, parent: shoulder, at: [0.5, 0], mass: 3.5,'
imported ramp
has ramp "a slope" 'slope: 0.1}' 'z is 0 on the floor, 0.3 m in the file' 'm inside the ground: raised by as much'
has ramp "names" 'body leg-1 is called leg_1' 'foot_1: {joint: hinge, parent: leg_1'
has ramp "a box is a sole, a wheel a disc" 'sole: {body: foot_1, from: [-0.06' 'rim: {body: wheel, at: [0, 0], radius: 0.08, friction_factor: 1.8}'
imported servos
has servos "servos" 'controller: {kind: hold, kp: 200, kd: 12}' 'shoulder: {body: upper, limit: 50}' 'elbow: {body: lower}'
has servos "gravity at a slant" 'x is the file'"'"'s (0.8 0 0.6), z its (-0.6 0 0.8)' 'gravity: 5}' \
    'axis: [0.9899494936611' 'nothing touches the ground'
imported swimmer --plane xy
has swimmer "a plane that lies" 'gravity across the plane, 9.81 m/s^2, is left out' 'the floor is left out' 'gravity: 0}'
imported sideways --weld roll --sole shoe.l=-0.1,-0.02,0.2,-0.02
has sideways "a joint that is held, a sole" 'joint roll is welded where it begins, at -0.174533' 'actuator side is left out: its joint is welded' \
    'shoe_l_1: {body: shoe_l, from: [-0.1, -0.02], to: [0.2, -0.02]}' 'pelvis: 0.174532925199'
imported heap
has heap "more contacts than there is room for" ' contacts more than there is room for are left out: c4, rib4,' \
    'rib8: {body: b8, at: [0.1, 0.05], radius: 0.02}'

# Small ones, written here: NAME, then has.
small() { # NAME OPTION... <file
    cat >"$1.xml"
    imported "$@"
}
floor='<geom name="floor" type="plane" size="1 1 1"/>'
small rail <<END
<mujoco><worldbody>$floor<body name="cart" pos="0 0 0.1"><joint name="rail" type="slide" axis="1 0 0"/><geom type="box" size="0.2 0.1 0.1"/>
<body name="pole"><joint name="pin" axis="0 1 0" frictionloss="0.2"/><geom type="capsule" fromto="0 0 0 0 0 1" size="0.02"/></body></body>
<geom type="box" size="0.1 0.1 0.1" pos="3 0 0.1"/></worldbody><actuator><motor joint="rail" gear="-3" ctrllimited="true" ctrlrange="0 2"/></actuator></mujoco>
END
has rail "what is on a rail touches nothing" 'cart touches no ground: its rail holds it' 'pole_1: {body: pole, from: [0, 0], to: [0, 1], radius: 0.02}' \
    'left out, as the ground is one half plane: box' 'dry friction in joint pin, 0.2, is left out' 'gives -6 to 0 in the file, -6 to 6 here' "title: 'rail.xml'"
small boom <<END
<mujoco model="a boom's hopper"><worldbody>$floor<body name="hip" pos="0 0 1"><joint name="along" type="slide" axis="1 0 0" damping="2"/>
<joint name="height" type="slide" axis="0 0 1"/><joint name="tilt" axis="0 1 0"/><geom size="0.1"/></body></worldbody></mujoco>
END
has boom "a root with dampers is slides and a hinge" 'along: {joint: slide,' 'damping: 2}' 'height: {joint: slide, parent: along' \
    'hip: {joint: hinge, parent: height, mass: 4.18879' "title: 'a boom''s hopper'"
small words <<END
<mujoco>
<worldbody>$floor<body name="on" pos="0 0 1"><freejoint/><geom size="0.1"/>
<body name="vleg" pos="0 0 -0.2"><joint name="y" axis="0 1 0"/><geom size="0.05"/></body><body name="leg" pos="0 0 -0.2"><joint axis="0 1 0"/><geom size="0.05"/></body>
<body name="h&#252;fte/1" pos="0 0 -0.2"><joint axis="0 1 0"/><geom size="0.05"/></body></body></worldbody>
<actuator><motor name="pull" joint="y"/></actuator></mujoco>
END
has words "words of the format, rates, letters" 'body on is called on_' 'body leg is called leg_' 'body hüfte/1 is called h__fte_1' 'y_: {body: vleg}' \
    'the motor of joint y is called y_'
small wide <<END
<mujoco model="wide"><worldbody><geom name="hill" type="box" size="5 1 0.1" pos="0 0 -0.1" euler="0 10 0"/>
<body name="ball" pos="0 0 1"><freejoint/><geom name="skin" size="0.1"/></body></worldbody></mujoco>
END
has wide "a box that is as wide as ground" 'box hill is the ground, without ends' 'slope: 0.17453292' 'skin: {body: ball, at: [0, 0], radius: 0.1}'
small adrift <<END
<mujoco><option><flag gravity="disable" limit="disable" passive="disable" actuation="disable"/></option><worldbody>$floor
<body name="hull" pos="0 0 1"><freejoint/><geom contype="0" conaffinity="0" size="0.1"/><body name="fin" pos="0.3 0 0">
<joint name="rudder" axis="0 1 0" limited="true" range="-9 9" damping="2"/><geom contype="0" conaffinity="0" size="0.1"/></body></body></worldbody>
<actuator><motor joint="rudder" gear="3"/></actuator></mujoco>
END
has adrift "what the file turns off" 'disabled in the file, and left out: limits of joints, springs and dampers, gravity' 'gravity: 0}' \
    'its motors drive' 'no shape may touch the ground; --sole LINK=X,Z,X,Z gives one'
small nearly --sole leg=0,0,1,0 <<END
<mujoco><option gravity="1e-5 0 -9.81"/><worldbody><body name="leg"><joint name="pin" axis="0 1 0"/><geom contype="0" conaffinity="0" size="0.1" pos="0 0 1"/></body></worldbody></mujoco>
END
has nearly "rounding is no slope" "off the file's z by 1e-06 rad: taken as along it" 'leg: {joint: hinge, mass' 'there is no ground here: --sole is left out'
small pair --weld aim <<END
<mujoco><worldbody>$floor<body name="arm" pos="0 0 1"><joint name="pin" axis="0 1 0"/><geom name="a" size="0.1"/><geom size="0.1 0.2 0.1" type="ellipsoid" pos="0 0 -.2"/></body>
<body name="goal" pos="0 0 1"><joint name="aim" type="slide" axis="1 0 0"/><geom size="0.01" contype="0" conaffinity="0"/></body></worldbody></mujoco>
END
has pair "shapes without names" 'touch nothing here: ellipsoid of arm'

# ---- the command -------------------------------------------------------------------------------------------------
expect "a file that is there is left alone" 3 "$stance" import "$robots/classes.xml" -o classes.yaml \
    says 'stance import: classes.yaml exists; --force replaces it'
expect "unless --force" 0 "$stance" import "$robots/classes.xml" -o classes.yaml --force
"$stance" import "$robots/classes.xml" >out 2>log && cmp -s out classes.yaml && "$stance" import "$robots/classes.xml" -o - | cmp -s - out
result $? "standard output has the same"
tells "... and what is told goes to standard error" '2 joints, 3 contacts' 'accelerations agree with the file'
expect "it runs" 0 "$stance" run classes.yaml -o classes.h5 --set stop.time=0.2
expect "no such file" 3 "$stance" import none.xml says 'stance import: none.xml: No such file or directory'
ln -s nowhere dangling.yaml
for place in . dangling.yaml; do expect "... nor $place" 3 "$stance" import "$robots/classes.xml" -o "$place"; done
[ -L dangling.yaml ] && [ "$(cat log)" = "stance import: dangling.yaml exists; --force replaces it" ]
result $? "... a link to nothing"
rm dangling.yaml
mkfifo pipe
for file in . pipe; do expect "what is no regular file is refused" 3 "$stance" import "$file"; done
says "... and not waited for" 'is no regular file'
for root in mujoco robot; do
    { echo "<$root>"; head -c 17000000 /dev/zero; } >vast
    expect "a file of 17 MB is refused" 3 "$stance" import vast says '^stance import: vast is larger than 16 MiB'
done
expect "a place that is none" 3 "$stance" import "$robots/classes.xml" -o none/classes.yaml
"$python" -c 'import sys, yaml
for name in sys.argv[1:]:
    for body in yaml.safe_load(open(name))["robot"]["bodies"].values():
        for value in body.values():
            assert not isinstance(value, str) or value.isidentifier(), value' ./*.yaml >log 2>&1
result $? "numbers are numbers to other readers, too"
is "nothing else is left behind" '! ls | grep -qE "part$|MUJOCO"'

# ---- refused -----------------------------------------------------------------------------------------------------
# Parts of a leg on a floor, with something else in one of them.
model() { # TRUNK LEG AFTER BEFORE FLOOR
    local floor='<geom name="floor" type="plane" size="1 1 1"/>'
    cat <<END
<mujoco model="m"><compiler angle="radian"/>
${4:-}
<worldbody>${5:-$floor}
<body name="trunk" pos="0 0 1"><freejoint name="root"/><geom name="t" size="0.1" mass="5"/>
<body name="leg" pos="0 0 -0.1"><joint name="hip" axis="0 1 0"/>
<geom name="l" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1"/>
${2:-}
</body>${1:-}</body></worldbody>
${3:-}
</mujoco>
END
}
toe() { echo "<body name='toe' pos='0 0 -0.4'><joint name='ankle' $1/><geom name='sh' ${2:-size='0.03'} mass='1'/></body>"; }
refused() { # WHAT PATTERN [OPTION...] <file: one line, which has the pattern and the file's name
    cat >bad.xml
    expect "refused: $1" 2 "$stance" import bad.xml -o bad.yaml "${@:3}" lines 1 tells 'bad\.xml' "$2" \
        is [ ! -e bad.yaml ]
}
chain() { # JOINTS
    local i
    for ((i = 0; i < $1; i++)); do
        echo "<body pos=\"0 0 -0.1\"><joint name=\"j$i\" axis=\"0 1 0\"/><geom size=\"0.02\" pos=\"0 0 -0.1\" mass=\"0.2\"/>"
    done
    for ((i = 0; i < $1; i++)); do echo "</body>"; done
}
motors() { local i; for ((i = 0; i < $1; i++)); do echo "<motor joint=\"j$i\"/>"; done; }
knee=$(toe 'axis="0 1 0"')
refused "a loop" 'bad.xml:9: loop \(equality connect\) ring ' < <(model '' '' '<equality><connect name="ring" body1="leg" body2="trunk" anchor="0 0 -0.4"/></equality>')
refused "a weld" 'loop \(equality weld\) glue' < <(model '' '' '<equality><weld name="glue" body1="leg"/></equality>')
refused "joints that are coupled" 'coupling of joints .* both ' < <(model '' "$knee" '<equality><joint name="both" joint1="hip" joint2="ankle"/></equality>')
refused "a tendon" 'tendon cord ' < <(model '' '' '<tendon><fixed name="cord" stiffness="3"><joint joint="hip" coef="1"/></fixed></tendon>')
refused "what pulls a tendon" "actuator 'pull' drives no joint" < <(model '' '' '<tendon><fixed name="cord"><joint joint="hip" coef="1"/></fixed></tendon><actuator><motor name="pull" tendon="cord"/></actuator>')
refused "what pushes a place" "actuator 'jet' drives no joint" < <(model '' '<site name="s"/>' '<actuator><general name="jet" site="s" gear="0 0 1 0 0 0"/></actuator>')
refused "a ball joint" "bad.xml:7: joint 'ankle' is a ball.*--weld ankle" < <(model '' "$(toe 'type="ball"')")
refused "a hinge out of the plane" "joint 'ankle' turns about \(1 0 0\), not along the normal.*--weld ankle" < <(model '' "$(toe 'axis="1 0 0"')")
refused "a slide out of the plane" "joint 'ankle' slides along .*--weld ankle" < <(model '' "$(toe 'type="slide" axis="0 1 1"')")
refused "hinges out of the plane that is asked for" "joint 'hip' turns about \(0 1 0\)" --plane yz < <(model)
name=a_joint_whose_name_has_forty_letters_or_more
refused "all that are out of the plane, by whole names" "--weld $name holds it \(so with ${name}_2, ${name}_3\)" < <(
    model "$(for i in 2 3; do toe "axis='1 0 $i'" | sed "s/ankle/${name}_$i/;s/'toe'/'t$i'/;s/name='sh'//"; done)" "$(toe 'axis="0 0 1"' | sed "s/ankle/$name/")")
refused "gravity across the plane" 'gravity \(0 -9.81 0\) is not in the plane.*--plane' < <(model '' '' '' '<option gravity="0 -9.81 0"/>')
refused "two trees" "bodies 'ball' and 'trunk' both begin a tree.*hold its joints with --weld: root, hip$" < <(model '' '' '' '' '<body name="ball" pos="2 0 1"><freejoint/><geom size="0.1"/></body>')
refused "nothing that moves" 'nothing moves' <<<'<mujoco><worldbody><body><geom size="0.1"/></body></worldbody></mujoco>'
refused "an actuator with a bias" "bad.xml:9: actuator 'odd' is neither" < <(model '' '' '<actuator><general name="odd" joint="hip" biastype="affine" biasprm="2 0 0"/></actuator>')
refused "an actuator with a state" "actuator 'slow' is neither" < <(model '' '' '<actuator><general name="slow" joint="hip" dyntype="filter" dynprm="0.1"/></actuator>')
refused "a muscle" "actuator 'flesh' is neither" < <(model '' '' '<actuator><muscle name="flesh" joint="hip" lengthrange="0.1 1"/></actuator>')
refused "two motors of one joint" "actuators 'one' and 'two' drive one joint" < <(model '' '' '<actuator><motor name="one" joint="hip"/><motor name="two" joint="hip"/></actuator>')
refused "a foot that is a mesh" "bad.xml:7: mesh sh of toe .*--sole toe=" < <(model '' "$(toe 'axis="0 1 0"' 'type="mesh" mesh="shoe"')" '' '<asset><mesh name="shoe" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .1"/></asset>')
refused "a foot that is an ellipsoid" "ellipsoid sh of toe .*--sole toe=" < <(model '' "$(toe 'axis="0 1 0"' 'type="ellipsoid" size="0.1 0.05 0.04"')")
refused "too many joints" '13 joints move; at most 10 .*--weld some of hip, j0, j1' < <(model '' "$(chain 12)")
refused "too many motors" '9 joints are driven; at most 8: --weld some of j0' < <(model '' "$(chain 9)" "<actuator>$(motors 9)</actuator>")
refused "a floor that is tilted across the plane" "floor 'floor' is tilted" < <(model '' '' '' '' '<geom name="floor" type="plane" size="1 1 1" euler="0.1 0 0"/>')
refused "a floor that is a wall" "floor 'floor' stands upright" < <(model '' '' '' '' '<geom name="floor" type="plane" size="1 1 1" euler="0 1.6 0"/>')
refused "a class that there is none of" 'bad.xml:5: MuJoCo cannot read it: .*unknown default class' < <(model | sed 's/axis="0 1 0"/& class="none"/')
refused "a moving body without mass" 'MuJoCo cannot read it: .*mass and inertia' < <(model '' '<body name="toe"><joint axis="0 1 0"/></body>')
refused "a plug-in" "unrecognized element .*plugin" < <(model '<plugin plugin="x"/>')
echo '<mujoco><worldbody><body><joint actuatorfrcrange="-1 1"/></body></worldbody></mujoco>' >newer.xml
refused "what is newer, in an include" "actuatorfrcrange.*, in a file that it includes: this is MuJoCo 2.2; take out what is newer" <<<'<mujoco><include file="newer.xml"/></mujoco>'
refused "an include that is not there" 'Include error.*missing.xml' <<<'<mujoco><include file="missing.xml"/></mujoco>'
refused "an include of itself" 'already included' <<<'<mujoco><include file="bad.xml"/></mujoco>'
refused "half a file" 'MuJoCo cannot read it' < <(model | head -c 300)
refused "an empty file" 'neither MJCF .* nor URDF' </dev/null
refused "another format" 'SDF files are not read' <<<'<?xml version="1.0"?><!-- a --><sdf version="1.6"><model/></sdf>'
refused "no format at all" 'neither MJCF .* nor URDF' < <(head -c 5000 "$stance")
refused "elements without end" 'MuJoCo cannot read it' < <(
    echo '<mujoco><worldbody>'
    for ((i = 0; i < 3000; i++)); do echo '<body>'; done
)
refused "a joint that is not there, to weld" "weld hips: there is no joint .*'hip'" --weld hips < <(model)
refused "a sole of no link" 'sole toe=0,0,1,0: there is no link' --sole toe=0,0,1,0 < <(model)
refused "a sole without length" 'its two ends are one place' --sole leg=0.1,0,0.1,0 < <(model)
refused "a sole of three numbers" 'write LINK=X,Z,X,Z' --sole leg=0,0,1 < <(model)
model | sed 's/mass="5"/mass="1e20"/' >bad.xml
expect "what the scenario's reader does not take is said, and not written" 2 "$stance" import bad.xml -o bad.yaml \
    tells '^stance import: bad.xml: as a scenario: robot.bodies.trunk.mass: 1.0e\+20 is out of range' \
    is [ ! -e bad.yaml ]
is "MuJoCo's errors leave no file behind" '! ls | grep -q MUJOCO'
