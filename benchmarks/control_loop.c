/* A control loop in C: what the operating system gives to any loop that sleeps until its deadlines.
   control_loop TICKS: prints whether SCHED_FIFO was granted, periods without a tick, nanoseconds of the latest tick, and how many
   ticks began 0, 1, 2, ... microseconds late, the last number for all that were later. */
#define _GNU_SOURCE
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>

enum { PERIOD_NS = 1000000, SECOND_NS = 1000000000, WIDEST_US = 4096 };
static long late_us[WIDEST_US];

int main(int count, char **words) {
    struct sched_param priority = {.sched_priority = 50};
    int real_time = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    mlockall(MCL_CURRENT | MCL_FUTURE);
    prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0); /* else whoever is not real time is woken 50 us later */
    long ticks = count > 1 ? atol(words[1]) : 1000, most_ns = 0, overruns = 0;
    struct timespec due, now;
    clock_gettime(CLOCK_MONOTONIC, &due);
    long due_ns = due.tv_sec * SECOND_NS + due.tv_nsec;
    for (long i = 0; i < ticks; i++) {
        due_ns += PERIOD_NS;
        due.tv_sec = due_ns / SECOND_NS, due.tv_nsec = due_ns % SECOND_NS;
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL) != 0) {}
        clock_gettime(CLOCK_MONOTONIC, &now);
        long late_ns = now.tv_sec * SECOND_NS + now.tv_nsec - due_ns, us = late_ns / 1000;
        late_us[us < WIDEST_US ? us : WIDEST_US - 1]++;
        if (late_ns > most_ns) most_ns = late_ns;
        overruns += late_ns / PERIOD_NS; /* not made up for: the next tick is due in step with the first */
        due_ns += late_ns / PERIOD_NS * PERIOD_NS;
    }
    printf("%d %ld %ld", real_time, overruns, most_ns);
    for (int us = 0; us < WIDEST_US; us++) printf(" %ld", late_us[us]);
    return 0;
}
