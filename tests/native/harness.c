/* harness LIBRARY GUID LOCATION INPUTS REALS STEPS: the library is loaded as a host loads it. */
#include "master.h"

#ifdef _WIN32
#include <windows.h>
#define LOAD(path) LoadLibraryA(path)
#define FIND(library, name) GetProcAddress(library, name)
#else
#include <dlfcn.h>
#define LOAD(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#endif

#include <string.h>

/* The address of a function as the pointer of its own type, which C's conversions cannot give. */
#define TAKE(member, name)                                                                                   \
    do {                                                                                                     \
        void *address = (void *)FIND(library, name);                                                         \
        memcpy(&fmu.member, &address, sizeof address);                                                       \
        missing += address == NULL;                                                                          \
    } while (0)

int main(int count, char **given)
{
    if (count != 7)
        return 2;
    void *library = (void *)LOAD(given[1]);
    if (!library) {
        fprintf(stderr, "%s cannot be loaded\n", given[1]);
        return 3;
    }
    Functions fmu;
    int missing = 0;
    TAKE(instantiate, "fmi2Instantiate");
    TAKE(setup, "fmi2SetupExperiment");
    TAKE(enter, "fmi2EnterInitializationMode");
    TAKE(leave, "fmi2ExitInitializationMode");
    TAKE(set, "fmi2SetReal");
    TAKE(get, "fmi2GetReal");
    TAKE(step, "fmi2DoStep");
    TAKE(terminate, "fmi2Terminate");
    TAKE(release, "fmi2FreeInstance");
    if (missing)
        return 4;
    int line = run(&fmu, given[2], given[3], (unsigned int)atoi(given[4]), (unsigned int)atoi(given[5]),
                   atoi(given[6]));
    if (line)
        fprintf(stderr, "master.h, line %d\n", line);
    return line ? 5 : 0;
}
