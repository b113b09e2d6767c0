"""An agent that asks a vision-language model where to go and whether it has found the goal.

| module | content |
|---|---|
| `chat` | questions to an OpenAI-compatible chat endpoint, with checked replies, and what they cost |
| `prompts` | the texts of the questions, `prompts.toml` or a file of the user |
| `pictures` | the map and the views with numbered places |
| `agent` | the agent: `stubborn-plus` with the model's choices |
"""
