/* model.json: everything of a model but its arrays. */
#ifndef MODALFMU_HEADER_H
#define MODALFMU_HEADER_H

#include "json.h"
#include "model.h"

#define HEADER "model/model.json"
#define HEADER_CHECKSUM "model/model.sha256"
#define AGAIN "build the FMU again"
#define ARRAY_LIMIT ((size_t)1 << 31) /* bytes of one array; a larger one is no reduced model's */

/* Whether a value is there and of this kind; refused under the name `what` where not. */
INTERNAL bool is_of_kind(const Json *value, JsonKind kind, const char *what, Reason *reason);

/* The member of an object, of this kind; NULL with a reason where it is not there, or no object is given. */
INTERNAL const Json *expected_member(const Json *object, const char *key, JsonKind kind, Reason *reason);

/* Whether the text is a C identifier; refused under the name `what` where not. */
INTERNAL bool is_identifier(const Json *text, const char *what, Reason *reason);

/* The model that the file describes, its arrays still NULL, in one block of memory; NULL with a reason. */
INTERNAL ReducedModel *described_model(const Json *header, const Memory *memory, Reason *reason);

#endif
