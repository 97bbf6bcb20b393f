#include "resources.h"

#include <stdio.h>
#include <string.h>

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#define NOUSER /* whose INPUT is another one */
#define NOGDI  /* whose names are too many */
#include <windows.h>

/* Opens a file for reading; the path is UTF-8 or, where it is not, in the code page of the system. */
static FILE *open_file(const char *path, const Memory *memory)
{
    UINT page = CP_UTF8;
    int length = MultiByteToWideChar(page, MB_ERR_INVALID_CHARS, path, -1, NULL, 0);
    if (length == 0) {
        page = CP_ACP;
        length = MultiByteToWideChar(page, 0, path, -1, NULL, 0);
    }
    wchar_t *wide = length > 0 ? memory->allocate((size_t)length, sizeof *wide) : NULL;
    if (!wide)
        return NULL;
    FILE *file = MultiByteToWideChar(page, 0, path, -1, wide, length) > 0 ? _wfopen(wide, L"rb") : NULL;
    memory->release(wide);
    return file;
}

#else

static FILE *open_file(const char *path, const Memory *memory)
{
    (void)memory;
    return fopen(path, "rb");
}

#endif

/* The whole of an open file, its size checked before anything is allocated. */
static bool read_whole(FILE *file, const char *name, size_t limit, const Memory *memory, Bytes *content,
                       Reason *reason)
{
    long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (size < 0 || fseek(file, 0, SEEK_SET) != 0)
        return refuse(reason, "%s: cannot be read", name);
    if ((unsigned long)size > limit)
        return refuse(reason, "%s: got %ld bytes, expected at most %zu", name, size, limit);
    content->size = (size_t)size;
    content->bytes = memory->allocate(content->size + 1, 1);
    if (!content->bytes)
        return refuse(reason, "%s: no memory for its %zu bytes", name, content->size);
    if (fread(content->bytes, 1, content->size, file) == content->size)
        return true;
    memory->release(content->bytes);
    content->bytes = NULL;
    return refuse(reason, "%s: cannot be read", name);
}

static bool read_from_folder(const void *context, const char *name, size_t limit, const Memory *memory,
                             Bytes *content, Reason *reason)
{
    const char *folder = context;
    size_t length = strlen(folder), name_size = strlen(name) + 1;
    char *path = memory->allocate(length + 1 + name_size, 1);
    if (!path)
        return refuse(reason, "%s: no memory for its path", name);
    memcpy(path, folder, length);
    path[length] = '/';
    memcpy(path + length + 1, name, name_size);
    FILE *file = open_file(path, memory);
    memory->release(path);
    if (!file)
        return refuse(reason, "%s: cannot be opened in the folder %s", name, folder);
    bool done = read_whole(file, name, limit, memory, content, reason);
    fclose(file);
    return done;
}

Files files_of_folder(const char *folder)
{
    return (Files){read_from_folder, folder};
}
