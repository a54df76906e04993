// The command `entoptic`.
#include "app/cli/command.h"

int main(int argc, char** argv) { return entoptic::app::run_command_line({argv + 1, argv + argc}); }
