"""Models over HTTP: a server of detectors in the forms that published agents use.

| module | content |
|---|---|
| `frames` | a picture with its truth, as the simulator registers it, and how a picture finds its truth again |
| `words` | words of requests and replies, as categories of this project |
| `detectors` | what is in a frame, by truth, with a network's errors, or by the shipped network |
| `server` | the answers over HTTP |
| `client` | requests to a service, with retries and a cache |
| `remote` | a segmenter that asks a server |
| `hosting` | sockets and logs of a server |
"""
