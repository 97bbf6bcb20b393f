#include "location.h"

#include <string.h>

#define EXPECTED "expected a file URI such as file:///folder/resources"

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Whether the text begins with this lower-case word, in letters of either case. */
static bool begins_with(const char *text, const char *word)
{
    for (; *word; text++, word++)
        if (*text != *word && !(is_letter(*text) && (*text | 0x20) == *word))
            return false;
    return true;
}

/* Characters before the colon of a scheme [RFC 3986, 3.1], 0 where there is none; one letter is a drive. */
static size_t scheme_length(const char *uri)
{
    size_t length = is_letter(uri[0]);
    while (length && (is_letter(uri[length]) || (uri[length] && strchr("0123456789+-.", uri[length]))))
        length++;
    return uri[length] == ':' && length > 1 ? length : 0;
}

/* The value of a hexadecimal digit, -1 of another character. */
static int hexadecimal(char c)
{
    static const char digits[] = "0123456789abcdefABCDEF";
    const char *found = c ? strchr(digits, c) : NULL;
    int value = found ? (int)(found - digits) : -1;
    return value < 16 ? value : value - 6;
}

/* Takes %20 and its like for what they stand for, in place [RFC 3986, 2.1]; a path cannot hold %00. */
static bool unescape(char *text)
{
    char *to = text;
    for (; *text; text++) {
        char c = *text;
        if (c == '%') {
            int high = hexadecimal(text[1]), low = high < 0 ? -1 : hexadecimal(text[2]);
            if (low < 0 || high + low == 0)
                return false;
            c = (char)(unsigned char)(high << 4 | low);
            text += 2;
        }
        *to++ = c;
    }
    *to = 0;
    return true;
}

/* C:/ or C: alone, with any slash; the colon was once written as a bar. */
static bool is_drive(const char *path)
{
    return is_letter(path[0]) && (path[1] == ':' || path[1] == '|') &&
           (path[2] == 0 || path[2] == '/' || path[2] == '\\');
}

/* The path in what follows file: [RFC 8089], which is always an end of it; NULL where there is none.
 *
 * Two slashes begin a host, one, or three and more, a path of this machine. On Windows any number of slashes
 * may stand before a drive, and a host, or what comes after four slashes, is a server: //server/share. */
static char *path_of_uri(char *text, bool windows, Reason *reason)
{
    const char *slash = windows ? "/\\" : "/";
    bool local = begins_with(text, "//localhost") && (text[11] == 0 || strchr(slash, text[11]));
    if (local)
        text += 11;
    size_t slashes = strspn(text, slash);
    char *path = text + slashes;
    bool host = slashes == 2 && *path && !local;
    if (windows && is_drive(path)) {
        path[1] = ':';
        return path;
    }
    if (windows && *path && (slashes == 2 || slashes >= 4))
        return path - 2;
    if (host) {
        refuse(reason, "fmuResourceLocation names a host, //%s, expected a path of this machine", path);
        return NULL;
    }
    if (slashes == 0 || (slashes == 2 && !*path && !local)) {
        refuse(reason, "fmuResourceLocation has no absolute path, " EXPECTED);
        return NULL;
    }
    return path - 1;
}

char *location_path(const char *uri, bool windows, const Memory *memory, Reason *reason)
{
    if (!uri || !*uri) {
        refuse(reason, "fmuResourceLocation is empty, " EXPECTED);
        return NULL;
    }
    size_t scheme = scheme_length(uri), length = strlen(uri);
    if (scheme && !begins_with(uri, "file:")) {
        refuse(reason, "fmuResourceLocation is %s, " EXPECTED, uri);
        return NULL;
    }
    char *text = memory->allocate(length + 1, 1), *path = text;
    if (!text) {
        refuse(reason, "no memory for the path of fmuResourceLocation");
        return NULL;
    }
    memcpy(text, uri, length + 1);
    if (scheme && !unescape(text)) {
        refuse(reason, "fmuResourceLocation is %s, expected two digits 0 ... F, not 00, behind each %%", uri);
        path = NULL;
    } else if (scheme) {
        path = path_of_uri(text + scheme + 1, windows, reason);
    }
    if (!path) {
        memory->release(text);
        return NULL;
    }
    length = strlen(path);
    while (length > 0 && strchr(windows ? "/\\" : "/", path[length - 1]))
        length--;
    memmove(text, path, length);
    text[length] = 0;
    return text;
}

char *resource_location(const char *uri, const Memory *memory, Reason *reason)
{
#ifdef _WIN32
    return location_path(uri, true, memory, reason);
#else
    return location_path(uri, false, memory, reason);
#endif
}
