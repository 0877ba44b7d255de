/* law_math.h - what stance_law.h calls sin, cos and so on. */
#ifndef LAW_MATH_H
#define LAW_MATH_H

double law_sin(double x);
double law_cos(double x);
double law_tan(double x);
double law_asin(double x);
double law_acos(double x);
double law_atan(double x);
double law_atan2(double y, double x);
double law_exp(double x);
double law_tanh(double x);
double law_floor(double x);

#endif
