/* SPDX-License-Identifier: BSD-3-Clause */
/** Descriptors that go along with messages between processes (unix(7), SCM_RIGHTS). */
#ifndef VXM_BATCH_DESCRIPTOR_H
#define VXM_BATCH_DESCRIPTOR_H

#include <string.h>
#include <sys/socket.h>

/** Room for one in a message. */
typedef union batch_descriptor_room {
  struct cmsghdr head;
  char bytes[CMSG_SPACE(sizeof(int))];
} batch_descriptor_room;

/** Sends a descriptor along; none if it is negative. */
static inline void batch_descriptor_attach(struct msghdr *message, batch_descriptor_room *room,
                                           int descriptor) {
  if (descriptor < 0)
    return;
  memset(room, 0, sizeof *room);
  message->msg_control = room;
  message->msg_controllen = sizeof room->bytes;
  struct cmsghdr *rights = CMSG_FIRSTHDR(message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  rights->cmsg_len = CMSG_LEN(sizeof descriptor);
  memcpy(CMSG_DATA(rights), &descriptor, sizeof descriptor);
}

/** The descriptor that came along with a message, now the receiver's; -1 = none. */
static inline int batch_descriptor_take(struct msghdr *message) {
  int descriptor = -1;
  struct cmsghdr *rights = CMSG_FIRSTHDR(message);
  if (rights && rights->cmsg_level == SOL_SOCKET && rights->cmsg_type == SCM_RIGHTS)
    memcpy(&descriptor, CMSG_DATA(rights), sizeof descriptor);
  return descriptor;
}

#endif
