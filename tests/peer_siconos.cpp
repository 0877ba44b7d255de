/* peer_siconos.cpp - Siconos on the charts of `stance bench accuracy`: Moreau and Jean's scheme.
 *
 * The biped is a Lagrangian system in x, z, theta, q1, q2 whose mass and forces come from the
 * Jacobians of its four points, m sum J'J and m J'(J'v + g); feet are relations with Newton's
 * impact and Coulomb's law in two dimensions. A law that acts all the time is part of the forces,
 * with its gains in the iteration matrix; torques that are held are constant.
 */
#include "peer.h"

#include <BlockVector.hpp>
#include <FrictionContact.hpp>
#include <Friction_cst.h>
#include <Interaction.hpp>
#include <LagrangianDS.hpp>
#include <LagrangianScleronomousR.hpp>
#include <MoreauJeanOSI.hpp>
#include <NewtonImpactFrictionNSL.hpp>
#include <NonSmoothDynamicalSystem.hpp>
#include <SiconosMatrix.hpp>
#include <SiconosVector.hpp>
#include <SimpleMatrix.hpp>
#include <SolverOptions.h>
#include <TimeDiscretisation.hpp>
#include <TimeStepping.hpp>

#include <memory>
#include <unistd.h>

static const struct peer_request *request;

/* ---- the robot ---------------------------------------------------------------------------- */

/* Point k, of trunk, hip and feet: where it is, its Jacobian, and its acceleration at rates v
 * without any of the coordinates' own. */
struct point {
    double at[2], by[2][5], drift[2];
};

static point make_point(int k, const double *q, const double *v)
{
    const double l = request->robot[0], lt = request->robot[1];
    point p = {{q[0], q[1]}, {{1, 0, 0, 0, 0}, {0, 1, 0, 0, 0}}, {0, 0}};
    if (k == 0)
        return p;
    const double s = sin(q[2]), c = cos(q[2]);
    p.at[0] += lt * s, p.at[1] -= lt * c;
    p.by[0][2] = lt * c, p.by[1][2] = lt * s;
    p.drift[0] = -lt * s * v[2] * v[2], p.drift[1] = lt * c * v[2] * v[2];
    if (k == 1)
        return p;
    const int own = k + 1; /* coordinate of the leg */
    const double sl = sin(q[2] + q[own]), cl = cos(q[2] + q[own]), w = v[2] + v[own];
    p.at[0] += l * sl, p.at[1] -= l * cl;
    p.by[0][2] += l * cl, p.by[1][2] += l * sl;
    p.by[0][own] = l * cl, p.by[1][own] = l * sl;
    p.drift[0] -= l * sl * w * w, p.drift[1] += l * cl * w * w;
    return p;
}

static double point_mass(int k)
{
    return k == 0 ? request->robot[3] : k == 1 ? request->robot[4] : request->robot[2];
}

static void make_mass(const double *q, double mass[5][5])
{
    static const double still[5] = {0};
    memset(mass, 0, 25 * sizeof(double));
    for (int k = 0; k < 4; k++) {
        const point p = make_point(k, q, still);
        for (int i = 0; i < 5; i++)
            for (int j = 0; j < 5; j++)
                mass[i][j] += point_mass(k) * (p.by[0][i] * p.by[0][j] + p.by[1][i] * p.by[1][j]);
    }
}

/* What stands on the left of Siconos' equation. */
static void make_force(const double *q, const double *v, const double torque[2], double force[5])
{
    memset(force, 0, 5 * sizeof(double));
    for (int k = 0; k < 4; k++) {
        const point p = make_point(k, q, v);
        for (int i = 0; i < 5; i++)
            force[i] += point_mass(k) *
                        (p.by[0][i] * p.drift[0] + p.by[1][i] * (p.drift[1] + request->gravity));
    }
    force[3] -= torque[0];
    force[4] -= torque[1];
}

class Biped : public LagrangianDS
{
  public:
    const double *held = nullptr; /* NULL: the law acts */

    Biped(SP::SiconosVector q, SP::SiconosVector v) : LagrangianDS(q, v)
    {
        _hasConstantMass = false;
        _mass.reset(new SimpleMatrix(5, 5));
        _fInt.reset(new SiconosVector(5));
        _jacobianFIntq.reset(new SimpleMatrix(5, 5));
        _jacobianFIntqDot.reset(new SimpleMatrix(5, 5));
        for (int i = 0; i < 2 && request->sample <= 0; i++) {
            for (int j = 0; j < 3; j++) {
                _jacobianFIntq->setValue(3 + i, 2 + j, request->gain[i][j]);
                _jacobianFIntqDot->setValue(3 + i, 2 + j, request->gain[i][3 + j]);
            }
        }
        _forces.reset(new SiconosVector(5));
        computeMass();
    }
    void computeMass() override
    {
        computeMass(_q[0]);
    }
    void computeMass(SP::SiconosVector position) override
    {
        double mass[5][5];
        make_mass(position->getArray(), mass);
        for (int i = 0; i < 5; i++)
            for (int j = 0; j < 5; j++)
                _mass->setValue(i, j, mass[i][j]);
    }
    void computeFInt(double time) override
    {
        computeFInt(time, _q[0], _q[1]);
    }
    void computeFInt(double, SP::SiconosVector q, SP::SiconosVector v) override
    {
        double torque[2];
        if (!held)
            peer_torque(request, q->getArray(), v->getArray(), torque);
        make_force(q->getArray(), v->getArray(), held ? held : torque, _fInt->getArray());
    }
    /* The law's part is constant; the rest is left to the iteration. */
    void computeJacobianFIntq(double) override
    {
    }
    void computeJacobianFIntqDot(double) override
    {
    }
    void computeJacobianFIntq(double, SP::SiconosVector, SP::SiconosVector) override
    {
    }
    void computeJacobianFIntqDot(double, SP::SiconosVector, SP::SiconosVector) override
    {
    }
};

class Foot : public LagrangianScleronomousR
{
    int which;

  public:
    explicit Foot(int foot) : which(foot)
    {
        _jachq.reset(new SimpleMatrix(2, 5));
    }
    void computeh(const BlockVector &q, BlockVector &, SiconosVector &y) override
    {
        static const double still[5] = {0};
        double at[5];
        for (int i = 0; i < 5; i++)
            at[i] = q.getValue(i);
        const point p = make_point(2 + which, at, still);
        y.setValue(0, p.at[1]);
        y.setValue(1, 0);
    }
    void computeJachq(const BlockVector &q, BlockVector &) override
    {
        static const double still[5] = {0};
        double at[5];
        for (int i = 0; i < 5; i++)
            at[i] = q.getValue(i);
        const point p = make_point(2 + which, at, still);
        for (int j = 0; j < 5; j++) {
            _jachq->setValue(0, j, p.by[1][j]);
            _jachq->setValue(1, j, p.by[0][j]);
        }
    }
};

/* ---- the engine --------------------------------------------------------------------------- */

struct setting_of {
    const char *name;
    double theta;
    int solver;
    bool usual, maps;
};
static const setting_of settings[] = {
    {"theta 0.5, NSGS", 0.5, SICONOS_FRICTION_2D_NSGS, true, false},
    {"theta 0.5, enumeration", 0.5, SICONOS_FRICTION_2D_ENUM, false, true},
    {"theta 0.5, Lemke", 0.5, SICONOS_FRICTION_2D_LEMKE, false, false},
    {"theta 1, enumeration", 1, SICONOS_FRICTION_2D_ENUM, false, true},
};
static const double steps[] = {4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5};
enum { SETTINGS = sizeof settings / sizeof *settings, STEPS = sizeof steps / sizeof *steps };

static const setting_of *chosen;
static double step_length;
static std::shared_ptr<Biped> biped;
static std::shared_ptr<Interaction> interaction[PEER_CONTACTS];
static std::shared_ptr<NonSmoothDynamicalSystem> system_of;
static std::shared_ptr<TimeStepping> simulation;

static const char *setting(const struct peer_request *r, int s, double *step, bool *usual)
{
    *step = steps[s % STEPS];
    *usual = settings[s / STEPS].usual;
    return r->labels && !settings[s / STEPS].maps ? NULL : settings[s / STEPS].name;
}

static bool begin(const struct peer_request *r, int s)
{
    request = r;
    chosen = &settings[s / STEPS];
    step_length = steps[s % STEPS];
    return true;
}

static void end(void)
{
    simulation.reset();
    system_of.reset();
    for (int c = 0; c < PEER_CONTACTS; c++)
        interaction[c].reset();
    biped.reset();
}

static void go_on(int, Simulation *)
{
}

static void start(const double *state)
{
    end();
    SP::SiconosVector q(new SiconosVector(5)), v(new SiconosVector(5));
    for (int i = 0; i < 5; i++) {
        q->setValue(i, state[i]);
        v->setValue(i, state[5 + i]);
    }
    biped.reset(new Biped(q, v));
    system_of.reset(new NonSmoothDynamicalSystem(0, 2 * request->time + 1));
    system_of->insertDynamicalSystem(biped);
    for (int c = 0; c < PEER_CONTACTS; c++) {
        if (request->feet[c]) {
            SP::NonSmoothLaw law(new NewtonImpactFrictionNSL(0, 0, request->friction, 2));
            SP::Relation relation(new Foot(c));
            interaction[c].reset(new Interaction(law, relation));
            system_of->link(interaction[c], biped);
        }
    }
    SP::TimeDiscretisation instants(new TimeDiscretisation(0, step_length));
    SP::OneStepIntegrator scheme(new MoreauJeanOSI(chosen->theta));
    SP::OneStepNSProblem problem(new FrictionContact(2, chosen->solver));
    simulation.reset(new TimeStepping(system_of, instants, scheme, problem));
    simulation->setNewtonTolerance(1e-10);
    simulation->setNewtonMaxIteration(50);
    simulation->setWarnOnNonConvergence(false);
    simulation->setCheckSolverFunction(go_on);
}

static void acceleration(const double *state, const double torque[2], double a[5])
{
    double m[5][5];
    make_mass(state, m);
    make_force(state, state + 5, torque, a);
    for (int i = 0; i < 5; i++) /* M is positive definite */
        a[i] = -a[i];
    for (int i = 0; i < 5; i++) {
        for (int j = i + 1; j < 5; j++) {
            const double f = m[j][i] / m[i][i];
            for (int k = i; k < 5; k++)
                m[j][k] -= f * m[i][k];
            a[j] -= f * a[i];
        }
    }
    for (int i = 4; i >= 0; i--) {
        for (int k = i + 1; k < 5; k++)
            a[i] -= m[i][k] * a[k];
        a[i] /= m[i][i];
    }
}

static double carried[PEER_CONTACTS];

static bool step(const double *torque)
{
    biped->held = torque;
    try {
        simulation->computeOneStep();
        for (int c = 0; c < PEER_CONTACTS; c++)
            carried[c] = interaction[c] ? interaction[c]->lambda(1)->getValue(0) / step_length : 0;
        simulation->nextStep();
    } catch (...) {
        return false;
    }
    return true;
}

static void state(double *state, double load[PEER_CONTACTS])
{
    memcpy(state, biped->q()->getArray(), 5 * sizeof(double));
    memcpy(state + 5, biped->velocity()->getArray(), 5 * sizeof(double));
    memcpy(load, carried, sizeof carried);
}

int main(int argc, char **argv)
{
    /* One core, as everybody; matrices of five rows are no work for threads. Read at loading. */
    if (argc > 0 && !getenv("OPENBLAS_NUM_THREADS")) {
        setenv("OPENBLAS_NUM_THREADS", "1", 1);
        execv("/proc/self/exe", argv);
    }
    const struct peer_engine siconos = {
        "Siconos", NULL, SETTINGS * STEPS, setting, begin, end, acceleration, start, step, state};
    return peer_main(&siconos);
}
