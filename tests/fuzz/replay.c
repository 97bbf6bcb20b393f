/* Runs a fuzz target over the files named on the command line, where there is no libFuzzer. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Prints the name first, so that the last one printed is the one that failed. */
static int replay(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *data = NULL;
    long size = -1;
    printf("%s\n", path);
    fflush(stdout);
    if (file && fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) >= 0 && fseek(file, 0, SEEK_SET) == 0)
        data = malloc((size_t)size + (size == 0));
    int failed = !data || fread(data, 1, (size_t)size, file) != (size_t)size;
    if (!failed)
        LLVMFuzzerTestOneInput(data, (size_t)size);
    free(data);
    if (file)
        fclose(file);
    return failed;
}

int main(int count, char **arguments)
{
    int failed = count < 2;
    for (int k = 1; k < count; k++)
        failed |= replay(arguments[k]);
    return failed;
}
