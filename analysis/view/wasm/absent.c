/* absent.c - what a page does without: files, and numerical libraries, which `event-driven` and
 * designs of controllers need. It has the designs of its results file (page_designs.c), and asks
 * for no other.
 */
#include "engine/control/design.h"
#include "engine/stance.h"

#include "runner/base/message.h"
#include "runner/plan/instruction_set.h"
#include "runner/scenario/reader.h"

#include <math.h>
#include <stdlib.h>

double gsl_cdf_ugaussian_Pinv(double p);

/* Known by name, without kernels: files that compare methods have cases of others. */
extern const stance_method stance_method_event_driven;
const stance_method stance_method_event_driven = {
    .name = "event-driven", .text = "not in a page", .tolerance = 1e-12};

static stance_error absent(stance_message *message)
{
    complain(message, "a page designs no controller");
    return STANCE_NUMERICAL;
}

stance_error stance_place(stance_placement how, const stance_plant *plant, double T,
                          const stance_poles *poles, double *K, stance_robustness *robustness,
                          stance_message *message)
{
    (void)how, (void)plant, (void)T, (void)poles, (void)K, (void)robustness;
    return absent(message);
}

stance_error stance_lqr(const stance_plant *plant, double T, const double *states,
                        const double *torques, double *K, stance_message *message)
{
    (void)plant, (void)T, (void)states, (void)torques, (void)K;
    return absent(message);
}

stance_error stance_discretise(const stance_plant *plant, double T, double *Ad, double *Bd)
{
    (void)plant, (void)T, (void)Ad, (void)Bd;
    return STANCE_NUMERICAL;
}

stance_error stance_selection_condition(const stance_scene *scene, const double *robot,
                                        const double *position, int selection, double *condition)
{
    (void)scene, (void)robot, (void)position, (void)selection;
    *condition = 1; /* what is singular was refused where the file was made */
    return STANCE_OK;
}

/* Of directions on a sphere: the page is given the points that its file has. */
double gsl_cdf_ugaussian_Pinv(double p)
{
    (void)p;
    return 0;
}

char *scenario_text(const char *file, struct problems *problems, size_t *length)
{
    (void)file, (void)length;
    problem_add(problems, (struct mark){0}, "a page reads no files");
    return NULL;
}

const char *reader_file(struct reader *r, const char *key, const struct tree_node *node,
                        size_t most)
{
    (void)key, (void)most;
    problem_add(&r->problems, node->mark, "a page reads no files");
    return NULL;
}

/* Plans may have cases of any method: page_case complains of those that cannot be simulated. */
const stance_kernel *instruction_set_kernel(const stance_scene *scene, const stance_method *method)
{
    static const stance_kernel some;
    (void)scene, (void)method;
    return &some;
}
