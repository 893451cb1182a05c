/* Loads an FMU's library, runs it and prints what comes out: run_library LIBRARY RESOURCES GUID COUNT.
   The first COUNT value references are read as real numbers after every hundredth of 1000 steps of 0.01 s. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(file) ((void *)LoadLibraryA(file))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)library, name))
#else
#include <dlfcn.h>
#define OPEN(file) dlopen(file, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#endif

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void say(void *environment, const char *instance, int status, const char *category, const char *message, ...) {
    va_list arguments;
    (void)environment, (void)instance, (void)category;
    if (status < 2) return;
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void *library;

static void *find(const char *name) {
    void *function = FIND(library, name);
    if (!function) {
        fprintf(stderr, "%s is not there\n", name);
        exit(3);
    }
    return function;
}

static void must(int status, const char *what) {
    if (status > 1) {
        fprintf(stderr, "%s answered %d\n", what, status);
        exit(4);
    }
}

int main(int argc, char **argv) {
    Callbacks callbacks = {say, calloc, free, NULL, NULL};
    if (argc != 5 || !(library = OPEN(argv[1]))) {
        fprintf(stderr, "cannot load %s\n", argc > 1 ? argv[1] : "");
        return 2;
    }
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) = find("fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) = find("fmi2SetupExperiment");
    int (*enter)(void *) = find("fmi2EnterInitializationMode"), (*leave)(void *) = find("fmi2ExitInitializationMode");
    int (*step)(void *, double, double, int) = find("fmi2DoStep"), (*terminate)(void *) = find("fmi2Terminate");
    int (*get)(void *, const unsigned *, size_t, double *) = find("fmi2GetReal");
    void (*release)(void *) = find("fmi2FreeInstance");
    void *unit = instantiate("unit", 1, argv[3], argv[2], &callbacks, 0, 0);
    if (!unit) return 5;
    must(setup(unit, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
    must(enter(unit), "fmi2EnterInitializationMode");
    must(leave(unit), "fmi2ExitInitializationMode");
    unsigned count = (unsigned)atoi(argv[4]);
    for (int n = 0; n < 1000; n++) {
        must(step(unit, n * 0.01, 0.01, 1), "fmi2DoStep");
        for (unsigned i = 0; n % 100 == 99 && i < count; i++) {
            double value;
            unsigned long long bits;
            must(get(unit, &i, 1, &value), "fmi2GetReal");
            memcpy(&bits, &value, sizeof bits);
            printf("%016llx\n", bits);
        }
    }
    must(terminate(unit), "fmi2Terminate");
    release(unit);
    return 0;
}
