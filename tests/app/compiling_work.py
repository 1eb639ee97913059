"""Work for the processes in tests of compiling."""

import logging

from risorius.app.dataset.sharing import SampleBatch, make_samples
from risorius.app.workers import Send


def make_samples_and_name_kernels(batch: SampleBatch, send: Send) -> None:
    """Make samples, and send the log's line for each kernel that this process compiles."""

    class Reports(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            send(record.getMessage())

    log = logging.getLogger("risorius.jit")
    log.addHandler(Reports())
    log.setLevel(logging.INFO)
    make_samples(batch, send)
