// bench_web.mjs - the biped's kernels as WebAssembly beside those of this machine and beside MuJoCo's
// own WebAssembly (npm: @mujoco/mujoco), one core each in turn, round after round: medians in ns a
// step, and millions of steps a second.
//
// node --no-warnings bench_web.mjs NATIVE WASM [DIRECTORY of @mujoco/mujoco]
// NATIVE, WASM: tests/bench_web.c, compiled. MuJoCo as in tests/bench_mujoco.c: the same robot, law, friction,
// step of 1 ms and starts, with its defaults and with all taken away that the robot can stand without; of the
// solver's sweeps it takes two here.
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [native, wasm, directory] = process.argv.slice(2);
const rounds = Number(process.env.ROUNDS ?? 7);
const steps = 1000, step = 1e-3, radius = 1e-4, gravity = 9.81;
const wasi = join(import.meta.dirname, "wasi.mjs");
const lines = (...command) => execFileSync(command[0], command.slice(1), { encoding: "utf8" }).trim().split("\n");
const engines = [
    ...["scalar", "avx2"].map((isa) => () => lines(native, isa)),
    () => lines(process.execPath, "--no-warnings", wasi, wasm, "wasm128"),
];

const settings = {
    "mujoco default": { options: "", flags: "", motors: true },
    "mujoco trimmed": {
        options: "solver='PGS' iterations='2' tolerance='0' jacobian='dense'",
        flags: `<flag equality='disable' frictionloss='disable' limit='disable'
            actuation='disable' sensor='disable' filterparent='disable' refsafe='disable' clampctrl='disable'/>`,
        motors: false,
    },
};

// MJCF of the robot: the head of bench_mujoco.c explains it.
function model({ robot: [l, lt, m, mt, mh], friction, contacts }, { options, flags, motors }) {
    const leg = (i) => `<body pos='0 0 ${-lt}'><joint name='q${i + 1}' type='hinge' axis='0 -1 0'/>
        <inertial pos='0 0 ${-l}' mass='${m}' diaginertia='1e-9 1e-9 1e-9'/>
        <geom type='sphere' size='${radius}' pos='0 0 ${-l}' contype='${(contacts >> i) & 1}'
            conaffinity='${(contacts >> i) & 1}'/></body>`;
    const inertia = ((mt * mh) / (mt + mh)) * lt * lt;
    return `<mujoco><compiler angle='radian' inertiafromgeom='false'/>
        <option timestep='${step}' gravity='0 0 ${-gravity}' ${options}>${flags}</option>
        <default><geom friction='${friction} 0.005 0.0001'/></default>
        <worldbody><geom type='plane' size='0 0 1' pos='0 0 ${-radius}' contype='1' conaffinity='1'/>
        <body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/><joint type='hinge' axis='0 -1 0'/>
        <inertial pos='0 0 ${(-lt * mh) / (mt + mh)}' mass='${mt + mh}' diaginertia='${inertia} ${inertia} 1e-9'/>
        ${leg(0)}${leg(1)}</body></worldbody>
        ${motors ? "<actuator><motor joint='q1'/><motor joint='q2'/></actuator>" : ""}</mujoco>`;
}

async function mujoco() {
    const { default: load } = await import(pathToFileURL(join(directory, "mujoco.js")));
    const engine = await load();
    const regimes = lines(native, "cases").map((line) => JSON.parse(line));
    return Object.entries(settings).map(([name, setting]) => () =>
        regimes.map((regime) => {
            const body = engine.MjModel.from_xml_string(model(regime, setting));
            const data = new engine.MjData(body);
            const { gain, target, feedforward, limit } = regime;
            const torque = setting.motors ? data.ctrl : data.qfrc_applied.subarray(3);
            const { qpos, qvel } = data;
            const round = () => {
                const begin = performance.now();
                for (const [position, velocity] of regime.cases) {
                    engine.mj_resetData(body, data);
                    qpos.set(position);
                    qvel.set(velocity);
                    for (let k = 0; k < steps; k++) {
                        for (let i = 0; i < 2; i++) {
                            let sum = feedforward[i];
                            for (let j = 0; j < 3; j++)
                                sum -= gain[i][j] * (qpos[2 + j] - target[j]) + gain[i][3 + j] * qvel[2 + j];
                            torque[i] = Math.max(Math.min(sum, limit), -limit);
                        }
                        engine.mj_step(body, data);
                    }
                    if (!(qpos[1] > 0.5)) throw new Error(`${name}, ${regime.regime}: the robot fell`);
                }
                return ((performance.now() - begin) * 1e6) / (steps * regime.cases.length);
            };
            round(); // warms up
            const time = round();
            data.delete();
            body.delete();
            return `${regime.regime},,${name},${time}`;
        }),
    );
}

if (directory) engines.push(...(await mujoco()));
const times = new Map();
for (let round = 0; round < rounds; round++)
    for (const line of engines.flatMap((engine) => engine())) {
        const [regime, method, isa, ns] = line.split(",");
        const key = [regime, method, isa].join(",");
        times.set(key, [...(times.get(key) ?? []), Number(ns)]);
    }
const spread = (values) => values.sort((a, b) => a - b)[values.length >> 1];
console.log("regime     method     engine          ns / step    10^6 steps / s    x scalar");
for (const [key, values] of times) {
    const [regime, method, isa] = key.split(",");
    const ns = spread(values), scalar = times.get(`${regime},${method || "implicit"},scalar`);
    console.log(
        `${regime.padEnd(10)} ${method.padEnd(10)} ${isa.padEnd(14)} ${ns.toFixed(0).padStart(10)} ` +
            `${(1e3 / ns).toFixed(3).padStart(17)} ${(spread(scalar) / ns).toFixed(2).padStart(11)}`,
    );
}
