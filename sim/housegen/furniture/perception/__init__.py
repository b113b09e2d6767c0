"""Styles of the pool `wide`, which no split of episodes shows: they add variety to the training of perception.

Houses of this pool also show the styles of `train`. The styles were designed without looking at the held-out ones, so
that a network trained on them has not seen those.

Like those of `train`, sizes follow Neufert, Architects' Data, Panero & Zelnik, Human Dimension and Interior Space, the
European kitchen grid (EN 1116), common mattress sizes (EN 1334) and retail ranges, but vary more.
"""
