#include "../runner/command.h"
static int run(int c, char **v){(void)c;(void)v;return 0;}
const struct command command_speed = {"bench plot","","",run,""};
