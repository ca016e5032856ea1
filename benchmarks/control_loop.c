/* A control loop in C: what the operating system gives to any loop that sleeps until its deadlines.
   control_loop SECONDS: prints quantiles of the lateness in microseconds, p50 p99 p999 most, and whether SCHED_FIFO was granted. */
#define _GNU_SOURCE
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

enum { PERIOD_NS = 1000000, SECOND_NS = 1000000000, WIDEST_US = 100000 };
static long late_us[WIDEST_US];

static long quantile(double share, long ticks) {
    long below = 0, us = 0;
    for (; us < WIDEST_US && below < share * ticks; us++) below += late_us[us];
    return us > 0 ? us - 1 : 0;
}

int main(int count, char **words) {
    struct sched_param priority = {.sched_priority = 50};
    int real_time = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    mlockall(MCL_CURRENT | MCL_FUTURE);
    long ticks = count > 1 ? atof(words[1]) * (SECOND_NS / PERIOD_NS) : 1000, most = 0;
    struct timespec due, now;
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (long i = 0; i < ticks; i++) {
        due.tv_nsec += PERIOD_NS;
        if (due.tv_nsec >= SECOND_NS) due.tv_nsec -= SECOND_NS, due.tv_sec++;
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
        clock_gettime(CLOCK_MONOTONIC, &now);
        long us = ((now.tv_sec - due.tv_sec) * SECOND_NS + now.tv_nsec - due.tv_nsec) / 1000;
        late_us[us < WIDEST_US ? us : WIDEST_US - 1]++;
        if (us > most) most = us;
    }
    printf("%ld %ld %ld %ld %d\n", quantile(.5, ticks), quantile(.99, ticks), quantile(.999, ticks), most, real_time);
    return 0;
}
