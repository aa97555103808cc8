// guarded COMMAND...: runs it, and says and ends what it left running.
#include <cstdio>

#include "guardian.h"

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: guarded COMMAND...\n");
        return 2;
    }
    return runcert::test::guarded([argv] {
        execvp(argv[1], argv + 1);
        std::perror(argv[1]);
        return 127;
    });
}
