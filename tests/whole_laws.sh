#!/usr/bin/env bash
# Laws of the user's own, in C: equal to the program's own to the bit (laws.py); trusted before they are run; parts of the
# results; mistakes, and what does harm, each told in one line.
# about: runner/run runner/optimise analysis/gait analysis/plot
. "$(dirname "$0")/scratch.sh"
export XDG_CONFIG_HOME=$scratch/config
mkdir config

# ---- the same as the program's own ----------------------------------------------------------------
mkdir equal && (cd equal && PYTHONPATH=$tests "$python" "$tests/laws.py") >log 2>&1
mv log lines
retold lines

# ---- a law and a scenario of it -------------------------------------------------------------------
head='#include "stance_law.h"
void law(const struct sample *now, const struct parameters *is, struct memory *mine, struct torques *out)'
write() { # NAME, more keys of the controller; the law from the standard input
    cat >"$1.c"
    cat >"$1.yaml" <<Y
stance: 1
scene: biped
ground: {contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: program, file: $1.c, sample_time: 0.001, torque_limit: 10${2:+, $2}}
method: {name: midpoint, step: 0.001}
stop: {time: 1}
sweep: {grid: [{path: initial.offset.theta, values: [0, 0.01, 0.02]}]}
Y
}
write servo 'stiffness: 120' <<<"/* holds the joints where they are at the target */
#define PARAMETERS(X)                                                          \\
    X(stiffness, 100, \"N m/rad\", 0, 1e4, \"of both servos\") /* a comment */   \\
    X(damping[2], 5, \"N m s/rad\", 0, 1e3, \"of one \" \"and the other\")
$head
{
    out->hip1 = now->rest.hip1 - is->stiffness * (now->q.q1 - now->target.q1) - is->damping[0] * now->v.q1;
    out->all[1] = now->rest.all[1] - is->stiffness * (now->q.q2 - now->target.q2) - is->damping[1] * now->v.q2;
}"
expect "check runs nothing of a stranger's" 0 "$stance" check servo.yaml
tells "... says that it is C code" \
    '^law  *servo.c, C code, SHA-256 [0-9a-f]*\.\.\.: not trusted yet, `run` asks for --trust$'
tells "... and does not guess the cost" '^cost  *unknown: nothing is run'
expect "run asks for trust" 2 "$stance" run servo.yaml says 'add --trust$' is [ ! -e results/servo.h5 ]
expect "so does gait" 2 "$stance" gait servo.yaml
expect "so does ranges" 2 "$stance" ranges servo.yaml
expect "--trust runs it" 0 "$stance" run --trust servo.yaml -o servo.h5
expect "... from now on" 0 "$stance" run servo.yaml -o again.h5
expect "... and check tells the cost" 0 "$stance" check servo.yaml tells '^cost  *about'
expect "... as JSON, too" 0 "$stance" check servo.yaml --json holds 'law = said()["law"]
assert law == {"file": "servo.c", "sha256": hashlib.sha256(open("servo.c", "rb").read()).hexdigest(), "trusted": True}, law'
is "the user's file holds its hash" grep -q "$(sha256sum <servo.c | cut -d' ' -f1)" config/stance/trusted
sed -i 's/100, /101, /' servo.c
expect "another text asks anew" 2 "$stance" run servo.yaml -o other.h5
sed -i 's/101, /100, /' servo.c

# ---- parameters are keys --------------------------------------------------------------------------
expect "a parameter is described" 0 "$stance" describe --of servo.yaml controller.stiffness \
    tells 'number, 0 ... 10000 N m/rad, default 100' 'May be swept'
expect "a list of them" 0 "$stance" describe --of servo.yaml 'controller.damping[1]'
expect "may be swept" 0 "$stance" run servo.yaml --set 'sweep.grid[0]={path: "controller.damping[1]", from: 1, to: 9, count: 3}' -o swept.h5
h5dump -a '/controller.damping[1]/units' swept.h5 2>/dev/null | grep -q 'N m s/rad' || "$python" -c '
import h5py
f = h5py.File("swept.h5"); assert f["controller.damping[1]"].attrs["units"] in ("N m s/rad", b"N m s/rad")'
result $? "... with the unit that the law gives"
expect "out of range is told with its place" 2 "$stance" run servo.yaml --set controller.stiffness=-1 -o no.h5 \
    tells 'controller.stiffness: -1 is out of range \(0 ... 10000 N m/rad\)'
expect "a wrong name, too" 2 "$stance" check servo.yaml --set controller.stifness=3 tells "did you mean 'stiffness'"
cat >>servo.yaml <<'Y'
optimise: {vary: [law], candidates: 12, grow: [8], confirm: 8}
Y
expect "a search varies them" 0 "$stance" optimise servo.yaml -o search.h5 --force \
    --set 'sweep.grid=[{path: ground.friction, values: [0.8]}]' --set 'sweep.sample={method: sobol, count: 8, vary: [{path: initial.offset.theta, from: -0.02, to: 0.02}]}'
sed -i '$d' servo.yaml

# ---- part of the results --------------------------------------------------------------------------
holds "the file holds source and hash" 'import h5py, hashlib
f = h5py.File("servo.h5")
text = f.attrs["law_source"]; text = text if isinstance(text, bytes) else text.encode()
assert text == open("servo.c", "rb").read() and hashlib.sha256(text).hexdigest() == str(f.attrs["law_sha256"].astype(str) if hasattr(f.attrs["law_sha256"], "astype") else f.attrs["law_sha256"])'
mv servo.c away.c
expect "replay runs from that copy" 0 "$stance" replay servo.h5 --case 1 -o case.svg
XDG_CONFIG_HOME=$scratch/stranger expect "... which a stranger has to trust, too" 2 \
    "$stance" replay servo.h5 --case 1 -o case.svg tells 'add --trust'
mkdir -p stranger
is "... and can" 'XDG_CONFIG_HOME=$scratch/stranger "$stance" replay --trust servo.h5 --case 1 -o case.svg >log 2>&1'
expect "a missing file is told with its place" 2 "$stance" check servo.yaml \
    tells '^servo.yaml:5:35: controller.file: servo.c: No such file or directory$'
mv away.c servo.c
timeout "$patience" mpirun -n 2 "$stance" run servo.yaml -o two.h5 >log 2>&1
"$stance" compare servo.h5 two.h5 >log 2>&1
tells "two ranks give the same file" '^identical'
expect "a scenario without that kind refuses its keys" 2 "$stance" check "$shipped/basin_one_foot.yaml" --set controller.file=servo.c

# ---- memory, data, what is known ------------------------------------------------------------------
write knows 'data: numbers.txt' <<<"#define MEMORY(X) X(calls) X(sum[2])
$head
{
    mine->calls += 1;
    const double known = now->time + now->period + now->since + now->footfalls + now->foot + now->stands.foot1;
    out->hip1 = now->rest.hip1 + (DATA == 3 && data[2] == -2.5e-3 && mine->calls >= 1 && known == known ? 0 : NAN);
    out->hip2 = now->rest.hip2 + (now->time == 0 && now->stands.foot1 != 1 ? NAN : 0) +
                (fabs(now->time - (mine->calls - 1) * now->period) < 1e-9 ? 0 : NAN);
}"
printf '1, 2 # three\n-2.5e-3\n' >numbers.txt
expect "memory is the case's own, data come from a file" 0 "$stance" run --trust knows.yaml -o knows.h5
printf '1, two\n' >numbers.txt
expect "numbers that are none are told" 2 "$stance" check knows.yaml \
    tells "controller.data: numbers.txt:1: 'two' is no number"

# What remembers is judged at the end: it stays at its target for the whole time.
write stays 'stiffness: 300' <<<"#define PARAMETERS(X) X(stiffness, 100, \"N m/rad\", 0, 1e4, \"of both servos\")
#define MEMORY(X) X(calls)
$head
{
    mine->calls += 1;
    for (int i = 0; i < 2; i++)
        out->all[i] = -is->stiffness * (now->q.all[3 + i] - now->target.all[3 + i]) - 20 * now->v.all[3 + i] + now->rest.all[i];
}"

expect "design asks the law by differences" 0 "$stance" design equal/biped-law.yaml \
    tells '^  closed loop  *-4.6, -4.2, -3.9, -3.6, -3.3, -3$' 'spectral radius  *0.99685[0-9]*: stable'
expect "... not one that remembers" 0 "$stance" design stays.yaml tells 'cannot know: it remembers'
expect "which runs to the end" 0 "$stance" run --trust stays.yaml -o stays.h5 --set stop.time=2 holds '
f = h5py.File("stays.h5"); assert (f["end_time"][...][f["outcome"][...] == 1] == 2).all(), f["end_time"][...]'

# ---- what is wrong --------------------------------------------------------------------------------
# One line each, with the place where there is one; a crash is the law's, with the case.
wrong() { # NAME, CODE, PATTERN; the law from the standard input
    write "$1"
    timeout "$patience" "$stance" run --trust "$1.yaml" -o "$1.h5" --quiet >log 2>&1
    local code=$?
    [ "$code" = "$2" ] && [ "$(grep -cE -- "$3" log)" = 1 ] && [ "$(grep -vc 'leave out the equilibrium\|cases failed; the variable' log)" = 1 ]
    result $? "$1: $3"
}
wrong syntax 2 "^syntax.c:2:[0-9]*: error: expected" <<<"$head { out->hip1 = ; }"
wrong name 2 "^name.c:2:[0-9]*: error: 'struct torques' has no member named 'knee'" <<<"$head { out->knee = 1; }"
wrong nan 1 'law nan.c gives torques that are not finite in case 0, or others: such cases fail' <<<"$head { out->hip1 = 0.0 / 0.0; }"
wrong infinite 1 'law infinite.c gives torques that are not finite' <<<"$head { out->hip1 = 1 / (now->time - 0.5); }"
wrong bounds 2 'law bounds.c reached beyond an array in case 0' <<<"$head { for (int i = 0; i < 100; i++) out->all[i] = 1; }"
wrong wild 2 'law wild.c wrote beyond what is its own in case 0' <<<"$head { double *p = out->all; for (int i = 0; i < 4; i++) p[i] = 1; }"
wrong before 2 'law before.c wrote beyond what is its own in case 0' <<<"$head { double *p = out->all; p[-1] = 1; }"
wrong null 2 'law null.c crashed \(SIGSEGV\) in case 0' <<<"$head { *(volatile int *)0 = 1; }"
wrong divides 2 'law divides.c crashed \(SIGFPE\) in case 0' <<<"$head { volatile int z = 0, n = 7; out->hip1 = n % z; }"
wrong deep 2 'law deep.c crashed \(SIGSEGV\) in case 0' <<<"static double f(double x) { volatile char a[100]; a[0] = 1; return f(x + 1) + a[0]; }
$head { out->hip1 = f(1); }"
wrong endless 2 'law endless.c has not returned for 10 s of processor time in case 0' <<<"$head { volatile int i = 1; while (i); }"
wrong lasting 2 'lasting.c: has variables that outlive a call' <<<"static double last;
$head { last += 1; out->hip1 = last; }"
wrong prints 2 'prints.c: calls printf, which is none of' <<<"int printf(const char *, ...);
$head { printf(\"%d\\n\", (int)now->time); }"
wrong system 2 'system.c: calls system, which is none of' <<<"#include <stdlib.h>
$head { system(\"true\"); }"
wrong power 2 'power.c: calls pow, which is none of' <<<"$head { out->hip1 = pow(now->time, 2.5); }"
wrong lacks 2 'lacks.c: has no function law' <<<'#include "stance_law.h"'
wrong empty 2 'empty.c: does not include stance_law.h' <<<'static const int x = 1;'
wrong early 2 'early.c: has constructors' <<<"__attribute__((constructor)) void f(void) { __asm__ volatile(\"nop\"); }
$head {}"
wrong default 2 '^default.yaml:5:35: controller.file: default.c:1: a: its default 5 lies outside its range 0 ... 1$' <<<"#define PARAMETERS(X) X(a, 5, \"m\", 0, 1, \"too large\")
$head {}"
wrong unquoted 2 'unquoted.c:1: a: a text in quotes is missing' <<<"#define PARAMETERS(X) X(a, 5, m, 0, 1, \"no unit\")
$head {}"
wrong taken 2 'taken.c: its parameter delay is a key that every controller has' <<<"#define PARAMETERS(X) X(delay, 0, \"s\", 0, 1, \"a key\")
$head {}"
wrong many 2 'many.c:1: PARAMETERS: more than 64 numbers' <<<"#define PARAMETERS(X) X(a[40], 0, \"1\", 0, 1, \"a\") X(b[40], 0, \"1\", 0, 1, \"b\")
$head {}"
wrong macro 2 'macro.c:2: a: a number is missing' <<<"#define N 3
#define PARAMETERS(X) X(a[N], 0, \"1\", 0, 1, \"a\")
$head {}"
wrong swapped 2 'swapped.c: its PARAMETERS are b; to the compiler and a; to the scenario' <<<"#if 0
#define PARAMETERS(X) X(a, 1, \"1\", 0, 9, \"a\")
#else
#define PARAMETERS(X) X(b, 2, \"1\", 0, 9, \"b\")
#endif
$head {}"
wrong other 2 'other.c:1: includes "k.h": a law is one file' <<<"#include \"k.h\"
$head {}"
wrong section 2 'section.c: has variables that outlive a call' <<<"static double last __attribute__((section(\"mine\"))) = 1;
$head { last += 1; out->hip1 = last; }"
wrong loads 2 'loads.c: has constructors' <<<"void _init(void) { __asm__ volatile(\"nop\"); }
$head {}"
write commented <<<"/* #define PARAMETERS(X) X(b, 1, \"1\", 0, 9, \"old\") */
#define PARAMETERS(X) X(a, 1, \"1\", 0, 9, \"a // b\")
$head { out->hip1 = sin(asin(0.5)) + atan2(1, 1) + tan(0) + acos(1) - is->a; }"
expect "PARAMETERS in a comment are none" 0 "$stance" run --trust commented.yaml --set controller.a=2 -o commented.h5
expect "no file is a mistake" 2 "$stance" check commented.yaml --set 'controller={kind: program, sample_time: 0.001}'
expect "a list is no file" 2 "$stance" check commented.yaml --set 'controller.file=[a]'
printf '1,,2\n' >numbers.txt
expect "nor is nothing a number" 2 "$stance" check knows.yaml
# A law that reads the clock is judged by what it is in the end: by any ranks the same.
write clock <<<"$head
{
    const double k = now->time < 0.5 ? 300 : -50;
    for (int i = 0; i < 2; i++)
        out->all[i] = now->rest.all[i] - k * (now->q.all[3 + i] - now->target.all[3 + i]) - 30 * now->v.all[3 + i];
}"
for n in 1 3; do
    timeout "$patience" mpirun -n $n "$stance" run --trust clock.yaml -o "clock$n.h5" --quiet \
        --set 'sweep.grid=[{path: initial.offset.theta, from: -0.03, to: 0.03, count: 31}]' --set stop.time=3 >log 2>&1
done
"$stance" compare clock1.h5 clock3.h5 >log 2>&1
tells "a law that reads the clock is the same by any ranks" '^identical'
head -c 300000 /dev/zero | tr '\0' ' ' >large.c
write larger <<<"$head {}"
expect "a source that is too large" 2 "$stance" check larger.yaml --set controller.file=large.c
expect "a folder" 2 "$stance" check larger.yaml --set controller.file=.
printf '\xff\xfe' >bytes.c
expect "no text" 2 "$stance" check larger.yaml --set controller.file=bytes.c
expect "a law acts on samples" 2 "$stance" check larger.yaml --set controller.sample_time=0
CC=false expect "no compiler" 2 "$stance" run --trust larger.yaml -o larger.h5 \
    tells "larger.c: the compiler CC='false' does not run"
