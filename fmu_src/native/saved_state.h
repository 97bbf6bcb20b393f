/* Everything of an instance that a replay needs, as bytes. */
#ifndef MODALFMU_SAVED_STATE_H
#define MODALFMU_SAVED_STATE_H

#include "instance.h"

INTERNAL size_t saved_size(const Instance *instance);

/* Write the state to saved_size(instance) bytes. */
INTERNAL void save_state(Instance *instance, unsigned char *bytes);

/* Go back to what save_state wrote of an instance that was initialising then, or was not; refused, with
 * nothing changed, where the bytes are not of that kind. */
INTERNAL bool restore_state(Instance *instance, const unsigned char *bytes, bool initialising,
                            Reason *reason);

#endif
