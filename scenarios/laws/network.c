/* network.c - a network of one hidden layer balances the paper's biped on one foot.
 *
 *     torque = rest + W (tanh(V x + b) - tanh(b)),
 *
 * x the departures of three angles and their rates from the equilibrium, each by its unit. What is
 * subtracted makes the equilibrium one of the closed loop, whatever the weights. They come from
 * controller.data, of one network or of several: how many are inputs, hidden and outputs, the units
 * of the inputs, then of each network a row of V and its b for each hidden one, and W row by row.
 * train_network.py makes them.
 */
#define PARAMETERS(X) X(network, 0, "1", 0, 1e4, "which of those that the data have")
#include "stance_law.h"

enum { INPUTS = 6, MOST = 64, HEAD = 3 };

void law(const struct sample *now, const struct parameters *is, struct memory *mine,
         struct torques *out)
{
    const double x[INPUTS] = {now->q.theta - now->target.theta,
                              now->q.q1 - now->target.q1,
                              now->q.q2 - now->target.q2,
                              now->v.theta,
                              now->v.q1,
                              now->v.q2};
    const int hidden = (int)data[1], outputs = (int)data[2], row = INPUTS + 1;
    const int at = HEAD + INPUTS + (int)is->network * hidden * (row + outputs);
    double value[MOST];
    (void)mine;
    if (data[0] != INPUTS || outputs != ACTUATORS || hidden > MOST ||
        at + hidden * (row + outputs) > DATA) {
        out->all[0] = 0. / 0.; /* which fails: these are not its weights */
        return;
    }
    for (int h = 0; h < hidden; h++) {
        const double *const v = &data[at + h * row];
        double sum = v[INPUTS];
        for (int i = 0; i < INPUTS; i++)
            sum += v[i] * x[i] / data[HEAD + i];
        value[h] = tanh(sum) - tanh(v[INPUTS]);
    }
    for (int k = 0; k < outputs; k++) {
        out->all[k] = now->rest.all[k];
        for (int h = 0; h < hidden; h++)
            out->all[k] += data[at + hidden * row + k * hidden + h] * value[h];
    }
}
