"""A particle side that breaks the protocol once, in its window FAULT_STEP, and serves in a thread of its own."""

import threading

from python_participant import Participant

FAULT_STEP = 5


class Silence(Exception):
    pass


class Faulty(Participant):
    """Behaves well until step 5, then applies `fault(participant, body, arrays)` to its answer to `asked`, or raises to fall silent. A
    fault that returns something says that in place of `result`."""

    def __init__(self, endpoint, fault, asked="advance", **options):
        super().__init__(endpoint, voidage=0.5, drag=1000.0, **options)
        self.asked, self.fault = asked, fault

    def say(self, kind, body=None, arrays=None):
        if self.step == FAULT_STEP and kind == "result" and self.log[-1] == self.asked:
            body, arrays = dict(body or {}), dict(arrays or {})
            kind = self.fault(self, body, arrays) or kind
        super().say(kind, body, arrays)

    def serve_in_thread(self):
        def serve():
            try:
                self.serve()
            except (Silence, RuntimeError, TimeoutError):
                pass  # silent on purpose, or told off by the coordinator
            finally:
                self.socket.close()

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        return thread


def falls_silent(participant, body, arrays):
    raise Silence


def not_finite(participant, body, arrays):
    arrays["drag_source"][7, 1] = float("nan")


def voidage_wrong(participant, body, arrays):
    arrays["voidage"][3] -= 1e-3  # a plausible number, but the particles' volume says otherwise
