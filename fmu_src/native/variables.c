#include "variables.h"

Layout layout(const ReducedModel *model)
{
    size_t k = model->k, r = model->r, n = model->n;
    const size_t sizes[NO_VARIABLE] = {model->m, model->p, 1, 1, 2 * k, r, r, n, n, n, n};
    Layout found = {{0}};
    for (int group = INPUT; group < NO_VARIABLE; group++)
        found.start[group + 1] = found.start[group] + sizes[group];
    return found;
}

Group group_of(const Layout *layout, unsigned int reference, size_t *place)
{
    for (int group = INPUT; group < NO_VARIABLE; group++)
        if (reference < layout->start[group + 1]) {
            *place = reference - layout->start[group];
            return (Group)group;
        }
    *place = reference;
    return NO_VARIABLE;
}
